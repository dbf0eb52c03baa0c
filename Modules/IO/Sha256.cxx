// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/Sha256.h"

#include "mammoray/Foundation/Error.h"

#include <openssl/evp.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <vector>

namespace mammoray
{
namespace
{
namespace fs = std::filesystem;

std::vector<std::string> FilesOf(const std::string& path)
{
  if (!fs::is_directory(path))
  {
    return { path };
  }
  std::vector<std::string> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(path))
  {
    if (entry.is_regular_file())
    {
      files.push_back(entry.path().string());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

using Context = std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)>;

Context NewContext()
{
  Context context(EVP_MD_CTX_new(), EVP_MD_CTX_free);
  EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr);
  return context;
}

std::string DigestOf(EVP_MD_CTX* context)
{
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int size = 0;
  EVP_DigestFinal_ex(context, digest, &size);
  static constexpr char Digits[] = "0123456789abcdef";
  std::string text;
  for (unsigned int index = 0; index < size; ++index)
  {
    text += Digits[digest[index] >> 4];
    text += Digits[digest[index] & 15];
  }
  return text;
}
}

std::string Sha256OfFile(const std::string& path)
{
  return Sha256OfFiles(FilesOf(path));
}

std::string Sha256OfFiles(const std::vector<std::string>& paths)
{
  const Context context = NewContext();
  std::vector<char> buffer(1 << 20);
  for (const std::string& part : paths)
  {
    std::ifstream file(part, std::ios::binary);
    while (
      file.read(buffer.data(), static_cast<std::streamsize>(buffer.size())) || file.gcount() > 0)
    {
      EVP_DigestUpdate(context.get(), buffer.data(), static_cast<std::size_t>(file.gcount()));
    }
    if (!file.eof())
    {
      throw InputError(part + ": cannot be read");
    }
  }
  return DigestOf(context.get());
}

std::string Sha256OfText(const std::string& text)
{
  const Context context = NewContext();
  EVP_DigestUpdate(context.get(), text.data(), text.size());
  return DigestOf(context.get());
}
}
