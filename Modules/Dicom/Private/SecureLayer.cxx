// SPDX-License-Identifier: Apache-2.0
#include "Private/SecureLayer.h"

#include "mammoray/Foundation/Error.h"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmtls/tlslayer.h>

#include <openssl/ssl.h>
#include <openssl/x509v3.h>

#include <filesystem>

namespace mammoray
{
namespace
{
void Expect(const OFCondition& done, const std::string& what, const std::string& file)
{
  if (done.bad())
  {
    throw InputError(file + ": expected " + what + ", found none (" + done.text() + ")");
  }
}

void ExpectFile(const std::string& file, const std::string& what)
{
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored))
  {
    throw InputError(file + ": expected " + what + ", found no such file");
  }
}

/// OpenSSL compares the certificate with it in the handshake; DCMTK by itself does not.
void ExpectName(SSL_CTX* context, const std::string& host)
{
  X509_VERIFY_PARAM* checks = SSL_CTX_get0_param(context);
  X509_VERIFY_PARAM_set_hostflags(checks, X509_CHECK_FLAG_NO_PARTIAL_WILDCARDS);
  if (X509_VERIFY_PARAM_set1_ip_asc(checks, host.c_str()) != 1 &&
    X509_VERIFY_PARAM_set1_host(checks, host.c_str(), host.size()) != 1)
  {
    throw InputError("archive: expected a host's name or address, found '" + host + "'");
  }
}
}

std::unique_ptr<DcmTransportLayer> MakeSecureLayer(const DicomNode& node)
{
  const TlsSettings& tls = node.Tls;
  if (!tls.Wanted)
  {
    if (!tls.AuthoritiesFile.empty() || !tls.CertificateFile.empty() || !tls.KeyFile.empty())
    {
      throw InputError("archive: expected TLS where certificates or a key are named, found none");
    }
    return nullptr;
  }
  if (tls.CertificateFile.empty() != tls.KeyFile.empty())
  {
    throw InputError("archive: expected a certificate and its key, found one without the other");
  }
  auto layer = std::make_unique<DcmTLSTransportLayer>(NET_REQUESTOR, nullptr, OFTrue);
  if (layer->setTLSProfile(TSP_Profile_BCP195_ND).bad() || layer->activateCipherSuites().bad())
  {
    throw InputError("archive: expected an OpenSSL with TLS 1.2, found none");
  }
  layer->setCertificateVerification(DCV_requireCertificate);
  if (tls.AuthoritiesFile.empty())
  {
    SSL_CTX_set_default_verify_paths(layer->getNativeHandle());
  }
  else
  {
    const char* what = "certificates (PEM) of authorities";
    ExpectFile(tls.AuthoritiesFile, what);
    Expect(layer->addTrustedCertificateFile(tls.AuthoritiesFile.c_str(), DCF_Filetype_PEM), what,
      tls.AuthoritiesFile);
  }
  if (!tls.CertificateFile.empty())
  {
    ExpectFile(tls.CertificateFile, "a certificate (PEM)");
    ExpectFile(tls.KeyFile, "a key (PEM)");
    layer->setPrivateKeyPasswd(""); // never asked for: this runs unattended, too
    Expect(layer->setPrivateKeyFile(tls.KeyFile.c_str(), DCF_Filetype_PEM),
      "a key (PEM) without passphrase", tls.KeyFile);
#if PACKAGE_VERSION_NUMBER >= 369
    const OFCondition taken = layer->setCertificateFile(tls.CertificateFile.c_str(),
      DCF_Filetype_PEM, TSP_Profile_BCP195_ND);
#else
    const OFCondition taken =
      layer->setCertificateFile(tls.CertificateFile.c_str(), DCF_Filetype_PEM);
#endif
    Expect(taken, "a certificate (PEM)", tls.CertificateFile);
    if (!layer->checkPrivateKeyMatchesCertificate())
    {
      throw InputError(tls.KeyFile + ": expected the key of " + tls.CertificateFile +
        ", found that of another certificate");
    }
  }
  ExpectName(layer->getNativeHandle(), node.Host);
  return layer;
}
}
