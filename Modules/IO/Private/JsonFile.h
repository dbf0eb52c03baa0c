// SPDX-License-Identifier: Apache-2.0
// Reading JSON that people write, strictly: every refusal names file, place and key.
#ifndef mammoray_Private_JsonFile_h
#define mammoray_Private_JsonFile_h

#include <nlohmann/json.hpp>

#include <istream>
#include <string>
#include <vector>

namespace mammoray
{
/// The file's value. `what` it holds is for messages: "a material table". Throws InputError where
/// it cannot be read, on anything but JSON, on repeated keys, and on nesting deeper than 16.
nlohmann::json ParseJsonFile(const std::string& path, const std::string& what);
/// Parses a JSON text under the same rules; messages call it `where`.
nlohmann::json ParseJson(std::istream& text, const std::string& where, const std::string& what);

/// Throws InputError "PLACE: expected ..., found ..."; null: found nothing.
[[noreturn]] void RefuseJson(const std::string& place, const std::string& expected,
  const nlohmann::json* found);

/// An object of a file, which has no keys but those that are known.
class JsonObject
{
public:
  using Json = nlohmann::json;

  /// `place`: "scene.json: samples[2]". Throws InputError on anything but an object of these keys;
  /// `value` must outlive this.
  JsonObject(const Json& value, std::string place, const std::vector<std::string>& keys);
  /// The object at the root of a file.
  static JsonObject Root(const Json& value, const std::string& path,
    const std::vector<std::string>& keys);

  /// "scene.json: samples[2].unit".
  std::string PlaceOf(const std::string& key) const;
  [[noreturn]] void Refuse(const std::string& key, const std::string& expected) const;
  /// Null where the key is absent.
  const Json* Find(const std::string& key) const;
  /// The value of a key that must be there.
  const Json& Require(const std::string& key, const std::string& expected) const;
  /// A text that is not empty, printable.
  std::string Text(const std::string& key) const;
  /// Such texts, at least one.
  std::vector<std::string> Texts(const std::string& key) const;
  /// A whole number from `least` to `most`.
  int WholeNumber(const std::string& key, int least, int most) const;
  /// Leaves `value` alone when the key is absent.
  template <typename Accept>
  void Number(const std::string& key, const std::string& expected, Accept accept,
    double& value) const
  {
    if (const Json* found = this->Find(key))
    {
      if (!found->is_number() || !accept(found->get<double>()))
      {
        this->Refuse(key, expected);
      }
      value = found->get<double>();
    }
  }

private:
  const Json& Value;
  std::string Place;
  bool IsRoot = false;
};
}

#endif
