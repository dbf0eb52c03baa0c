// SPDX-License-Identifier: Apache-2.0
#include "Sha256.h"

#include "Error.h"

#include <openssl/evp.h>

#include <fstream>
#include <memory>
#include <vector>

namespace mammoray
{
std::string Sha256OfFile(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(
    EVP_MD_CTX_new(), EVP_MD_CTX_free);
  EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr);
  std::vector<char> buffer(1 << 20);
  while (file.read(buffer.data(), static_cast<std::streamsize>(buffer.size())) ||
    file.gcount() > 0)
  {
    EVP_DigestUpdate(context.get(), buffer.data(), static_cast<std::size_t>(file.gcount()));
  }
  if (!file.eof())
  {
    throw InputError(path + ": cannot be read");
  }
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int size = 0;
  EVP_DigestFinal_ex(context.get(), digest, &size);
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
