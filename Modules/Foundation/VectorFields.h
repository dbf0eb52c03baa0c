// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_VectorFields_h
#define mammoray_VectorFields_h

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace mammoray
{
/**
 * Vector fields over the same points in one array, ordered [field][point][3]: for example the
 * velocity of every point with each parameter. From the solver to the projectors they keep this
 * order.
 */
struct VectorFields
{
  /// Values[(field * pointCount + point) * 3 + axis].
  std::vector<double> Values;
  /// Length of one field: 3 * pointCount.
  std::size_t Length = 0;

  VectorFields() = default;
  /// Fields of zeros.
  VectorFields(std::size_t count, std::size_t length)
    : Values(count * length, 0.0)
    , Length(length)
  {
  }
  /// The fields in `values`, each of `length` values.
  VectorFields(std::vector<double> values, std::size_t length)
    : Values(std::move(values))
    , Length(length)
  {
  }
  std::size_t Count() const { return this->Length ? this->Values.size() / this->Length : 0; }
  std::span<double> operator[](std::size_t field)
  {
    return std::span(this->Values).subspan(field * this->Length, this->Length);
  }
  std::span<const double> operator[](std::size_t field) const
  {
    return std::span(this->Values).subspan(field * this->Length, this->Length);
  }
};
}

#endif
