// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Dicom/DicomNetwork.h"

#include "mammoray/Foundation/ValidRange.h"

#include <curl/curl.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <memory>
#include <sstream>

namespace mammoray
{
namespace
{
constexpr const char* Boundary = "mammoray-5f1c3a0e9b7d4e62";

/// Numbers of the first Failure Reason (0008,1197) in a Failed SOP Sequence (0008,1198).
std::string FailureReason(const nlohmann::json& failed)
{
  const nlohmann::json::json_pointer place("/Value/0/00081197/Value/0");
  const bool given = failed.contains(place) && failed.at(place).is_number();
  return "reason " + (given ? failed.at(place).dump() : std::string("not given"));
}

/// An answer, of which no more is kept than a sound one is long.
struct Answer
{
  static constexpr std::size_t Most = 1 << 20;
  std::string Text;

  static std::size_t Take(char* bytes, std::size_t size, std::size_t count, void* answer)
  {
    std::string& text = static_cast<Answer*>(answer)->Text;
    text.append(bytes, std::min(size * count, Most - std::min(Most, text.size())));
    return size * count;
  }
};

int AskToStop(void* stop, curl_off_t, curl_off_t, curl_off_t, curl_off_t)
{
  const auto& request = *static_cast<const StopRequest*>(stop);
  return request && request() ? 1 : 0;
}

class Session
{
public:
  Session(const DicomWebServer& server, const StopRequest& stop)
    : Server(server)
    , Stop(stop)
    , Handle(curl_easy_init(), curl_easy_cleanup)
  {
    for (const std::string& line :
      { std::string("Content-Type: multipart/related; type=\"application/dicom\"; boundary=") +
          Boundary,
        std::string("Accept: application/dicom+json"), std::string("Expect:") })
    {
      this->Headers.reset(curl_slist_append(this->Headers.release(), line.c_str()));
    }
    const auto set = [this](CURLoption option, auto value)
    { curl_easy_setopt(this->Handle.get(), option, value); };
    this->Address = server.Url + (server.Url.ends_with('/') ? "studies" : "/studies");
    set(CURLOPT_URL, this->Address.c_str());
    set(CURLOPT_PROTOCOLS_STR, "http,https");
    set(CURLOPT_FOLLOWLOCATION, 0L);
    set(CURLOPT_NOSIGNAL, 1L);
    set(CURLOPT_NETRC, static_cast<long>(CURL_NETRC_OPTIONAL));
    set(CURLOPT_HTTPHEADER, this->Headers.get());
    set(CURLOPT_CONNECTTIMEOUT, static_cast<long>(server.TimeoutSeconds));
    set(CURLOPT_LOW_SPEED_LIMIT, 1L);
    set(CURLOPT_LOW_SPEED_TIME, static_cast<long>(server.TimeoutSeconds));
    set(CURLOPT_ERRORBUFFER, this->Reason);
    set(CURLOPT_WRITEFUNCTION, &Answer::Take);
    set(CURLOPT_NOPROGRESS, 0L);
    set(CURLOPT_XFERINFOFUNCTION, &AskToStop);
    set(CURLOPT_XFERINFODATA, &this->Stop);
    if (!server.AuthoritiesFile.empty())
    {
      set(CURLOPT_CAINFO, server.AuthoritiesFile.c_str());
    }
  }

  /// Why the object was not stored; empty where it was.
  std::string Store(const std::string& path)
  {
    std::ostringstream body;
    body << "--" << Boundary << "\r\nContent-Type: application/dicom\r\n\r\n"
         << std::ifstream(path, std::ios::binary).rdbuf() << "\r\n--" << Boundary << "--\r\n";
    const std::string bytes = body.str();
    Answer answer;
    this->Reason[0] = '\0';
    curl_easy_setopt(this->Handle.get(), CURLOPT_POSTFIELDS, bytes.data());
    curl_easy_setopt(this->Handle.get(), CURLOPT_POSTFIELDSIZE_LARGE,
      static_cast<curl_off_t>(bytes.size()));
    curl_easy_setopt(this->Handle.get(), CURLOPT_WRITEDATA, &answer);
    const CURLcode result = curl_easy_perform(this->Handle.get());
    if (result == CURLE_ABORTED_BY_CALLBACK)
    {
      throw Interrupted();
    }
    this->Lost = result != CURLE_OK;
    if (this->Lost)
    {
      return this->Reason[0] != '\0' ? this->Reason : curl_easy_strerror(result);
    }
    long status = 0;
    curl_easy_getinfo(this->Handle.get(), CURLINFO_RESPONSE_CODE, &status);
    return WhyNotStored(status, answer.Text);
  }

  /// Whether the last object met no answer at all.
  bool IsLost() const { return this->Lost; }

private:
  bool Lost = false;
  const DicomWebServer& Server;
  StopRequest Stop;
  std::string Address;
  char Reason[CURL_ERROR_SIZE] = {};
  std::unique_ptr<CURL, void (*)(CURL*)> Handle;
  std::unique_ptr<curl_slist, void (*)(curl_slist*)> Headers{ nullptr, curl_slist_free_all };
};
}

std::string WhyNotStored(long status, const std::string& body)
{
  if (status != 200 && status != 202 && status != 409)
  {
    return "status " + std::to_string(status);
  }
  nlohmann::json json;
  try
  {
    json = nlohmann::json::parse(body, JsonNestingLimit{ "the archive's answer" }, false);
  }
  catch (const InputError& error)
  {
    return error.what();
  }
  if (json.is_object())
  {
    const auto failed = json.find("00081198");
    if (failed != json.end() && failed->is_object() && failed->contains("Value") &&
      !(*failed)["Value"].empty())
    {
      return FailureReason(*failed);
    }
  }
  return status == 409 ? "status 409" : std::string();
}

void StoreFilesOnWeb(const std::vector<std::string>& files, const DicomWebServer& server,
  const StoredCallback& stored, const StopRequest& stop)
{
  const std::string& url = server.Url;
  if (!url.starts_with("https://") && !url.starts_with("http://"))
  {
    throw InputError("archive: expected an address https://... or http://..., found '" + url + "'");
  }
  if (server.TimeoutSeconds < 1)
  {
    throw InputError(
      "time-out: expected at least 1 s, found " + std::to_string(server.TimeoutSeconds));
  }
  static const CURLcode global = curl_global_init(CURL_GLOBAL_DEFAULT);
  if (global != CURLE_OK)
  {
    throw NetworkError(std::string("libcurl: cannot be used (") + curl_easy_strerror(global) + ")");
  }
  Session session(server, stop);
  std::size_t count = 0;
  std::string refused;
  for (const std::string& file : files)
  {
    const std::string why = session.Store(file);
    count += why.empty() ? 1 : 0;
    refused += !refused.empty() || why.empty() ? "" : file + " (" + why + ")";
    if (stored)
    {
      stored(file, why);
    }
    if (session.IsLost())
    {
      break;
    }
  }
  if (count < files.size())
  {
    throw NetworkError("archive " + url +
      ": expected that it stores all objects, found that it does not: first " + refused +
      "; stored " + std::to_string(count) + " of " + std::to_string(files.size()));
  }
}
}
