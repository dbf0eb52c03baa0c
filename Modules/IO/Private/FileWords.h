// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_FileWords_h
#define mammoray_Private_FileWords_h

#include "Private/InputFile.h"
#include "mammoray/Foundation/Numbers.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <type_traits>

namespace mammoray
{
/// The bytes of a file, without a byte order mark of UTF-8, which are taken word by word. Blanks,
/// tabs and line ends (LF, CRLF, CR) part words.
class FileWords
{
public:
  explicit FileWords(const std::string& path)
    : Path(path)
  {
    std::ifstream file(path, std::ios::binary);
    this->Bytes.assign(std::istreambuf_iterator<char>(file), {});
    this->Rest = this->Bytes;
    if (this->Rest.starts_with("\xef\xbb\xbf"))
    {
      this->Rest.remove_prefix(3);
    }
  }
  FileWords(const FileWords&) = delete;
  FileWords& operator=(const FileWords&) = delete;

  std::size_t LineNow() const { return this->LineNumber; }
  /// What has not been taken.
  std::string_view Left() const { return this->Rest; }

  /// The next word; empty at the end of the file.
  std::string_view Next()
  {
    std::size_t begin = 0;
    for (; begin < this->Rest.size() && IsBlank(this->Rest[begin]); ++begin)
    {
      this->LineNumber += this->EndsLine(begin) ? 1 : 0;
    }
    std::size_t end = begin;
    for (; end < this->Rest.size() && !IsBlank(this->Rest[end]);)
    {
      ++end;
    }
    const std::string_view word = this->Rest.substr(begin, end - begin);
    this->Rest.remove_prefix(end);
    return word;
  }

  /// The rest of the line, without its end and without blanks around it.
  std::string_view Line()
  {
    const std::size_t end = std::min(this->Rest.find_first_of("\r\n"), this->Rest.size());
    std::string_view line = this->Rest.substr(0, end);
    const std::size_t next = end + (this->Rest.substr(end, 2) == "\r\n" ? 2 : 1);
    this->Rest.remove_prefix(std::min(next, this->Rest.size()));
    this->LineNumber += 1;
    while (!line.empty() && IsBlank(line.back()))
    {
      line.remove_suffix(1);
    }
    while (!line.empty() && IsBlank(line.front()))
    {
      line.remove_prefix(1);
    }
    return line;
  }

  void Skip(std::size_t count)
  {
    for (std::size_t at = 0; at < count; ++at)
    {
      this->LineNumber += this->EndsLine(at) ? 1 : 0;
    }
    this->Rest.remove_prefix(count);
  }

  /// The next word as a finite number.
  template <typename Value>
  Value Number(const char* expected)
  {
    const std::string_view word = this->Next();
    Value value{};
    bool isNumber = ToPaddedNumber(word, value);
    if constexpr (std::is_floating_point_v<Value>)
    {
      isNumber = isNumber && std::isfinite(value);
    }
    if (!isNumber)
    {
      this->Refuse(expected, word);
    }
    return value;
  }

  /// The next bytes as a value, in the byte order of this machine or the other one.
  template <typename Value>
  Value Binary(const char* expected, bool isSwapped = false)
  {
    Value value{};
    if (this->Rest.size() < sizeof value)
    {
      throw InputError(this->Path + ": expected " + expected + ", found the end of the file");
    }
    char bytes[sizeof value];
    std::memcpy(bytes, this->Rest.data(), sizeof value);
    if (isSwapped)
    {
      std::reverse(bytes, bytes + sizeof value);
    }
    std::memcpy(&value, bytes, sizeof value);
    this->Rest.remove_prefix(sizeof value);
    return value;
  }

  [[noreturn]] void Refuse(const std::string& expected, std::string_view found) const
  {
    throw InputError(LineName(this->Path, this->LineNumber) + ": expected " + expected +
      ", found " +
      (found.empty() ? "the end of the file" : "'" + std::string(found.substr(0, 60)) + "'"));
  }

private:
  /// Whether what has not been taken has the end of a line there; of CRLF its last byte.
  bool EndsLine(std::size_t at) const
  {
    return this->Rest[at] == '\n' ||
      (this->Rest[at] == '\r' && this->Rest.substr(at + 1, 1) != "\n");
  }
  static bool IsBlank(char letter)
  {
    return letter == ' ' || letter == '\t' || letter == '\n' || letter == '\r' || letter == '\f' ||
      letter == '\v';
  }

  const std::string Path;
  std::string Bytes;
  std::string_view Rest;
  std::size_t LineNumber = 1;
};

/// The text in lower case.
inline std::string LowerCase(std::string_view text)
{
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
    [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return lower;
}
}

#endif
