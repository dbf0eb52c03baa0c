// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Dicom/DicomNetwork.h"

#include "Private/DicomFile.h"
#include "Private/SecureLayer.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/GuardedRead.h"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <dcmtk/dcmnet/dcmlayer.h>
#include <dcmtk/dcmnet/dcmtrans.h>
#include <dcmtk/dcmnet/scu.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <utility>

namespace mammoray
{
static void Exchange(Parcel& parcel, ArchivedStudy& study)
{
  parcel(study.StudyInstanceUid, study.AccessionNumber, study.PatientId, study.Date,
    study.Description);
}

namespace
{
namespace fs = std::filesystem;

/// The result of a conversation with an archive, or the text of its NetworkError.
struct ArchiveAnswer
{
  std::vector<ArchivedStudy> Studies;
  std::string Failure;
};

void Exchange(Parcel& parcel, ArchiveAnswer& answer)
{
  parcel(answer.Studies, answer.Failure);
}

std::string NameOf(const DicomNode& node)
{
  return "archive " + node.Host + ":" + std::to_string(node.Port);
}

/// DCMTK's reason in one line.
std::string ReasonOf(const OFCondition& condition)
{
  std::string text = condition.text();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

/// Runs `talk`, a conversation with the archive, in a process of its own: DCMTK reads answers into
/// memory and by recursion, so endless or deeply nested ones end their process. The death of the
/// process is a NetworkError.
std::vector<ArchivedStudy> TalkTo(const DicomNode& node,
  const std::function<std::vector<ArchivedStudy>(const TellCallback& tell)>& talk,
  const TellCallback& heard)
{
  // An object of an archive has 4 GiB at most (PS3.5 7.1.1: lengths of 32 bits).
  const ReadLimits limits{ std::uint64_t{ 5 } << 30, std::numeric_limits<double>::infinity() };
  const auto answerOf = [&talk](const TellCallback& tell)
  {
    const std::shared_ptr<void> quiet = SilenceDcmtk();
    ArchiveAnswer answer;
    try
    {
      answer.Studies = talk(tell);
    }
    catch (const NetworkError& error)
    {
      answer.Failure = error.what();
    }
    return answer;
  };
  ArchiveAnswer answer;
  try
  {
    answer = ReadGuarded(NameOf(node), "answers of an archive", limits, answerOf, heard);
  }
  catch (const ReaderEnded& death)
  {
    throw NetworkError(death.what());
  }
  if (!answer.Failure.empty())
  {
    throw NetworkError(answer.Failure);
  }
  return answer.Studies;
}

void CheckTitle(const std::string& title)
{
  const bool bad = std::any_of(title.begin(), title.end(),
    [](unsigned char c) { return c < 0x20 || c > 0x7e || c == '\\'; });
  if (title.empty() || title.size() > 16 || bad)
  {
    throw InputError("application entity title: expected 1 to 16 characters of ASCII without '\\', "
                     "found '" +
      title + "'");
  }
}

/// Class and transfer syntax from the meta information of a file.
struct FileKind
{
  std::string Path;
  OFString SopClass;
  OFString Syntax;
};

FileKind KindOf(const std::string& path)
{
  FileKind kind;
  kind.Path = path;
  DcmFileFormat file;
  if (file.loadFile(path.c_str(), EXS_Unknown, EGL_noChange, DCM_MaxReadLength, ERM_metaOnly)
        .bad() ||
    file.getMetaInfo()->findAndGetOFString(DCM_MediaStorageSOPClassUID, kind.SopClass).bad() ||
    file.getMetaInfo()->findAndGetOFString(DCM_TransferSyntaxUID, kind.Syntax).bad())
  {
    throw InputError(path + ": expected a DICOM file, found none that says its class");
  }
  return kind;
}

/// A base, so that it outlives the connection.
struct LayerOwner
{
  std::unique_ptr<DcmTransportLayer> Layer;
};

/// A connection to the archive that ends with this object.
class Association
  : private LayerOwner
  , public DcmSCU
{
public:
  explicit Association(const DicomNode& node)
    : LayerOwner{ MakeSecureLayer(node) }
    , Node(node)
  {
    CheckTitle(node.CalledTitle);
    CheckTitle(node.CallingTitle);
    if (node.TimeoutSeconds < 1)
    {
      throw InputError(
        "time-out: expected at least 1 s, found " + std::to_string(node.TimeoutSeconds));
    }
    const auto seconds = static_cast<Uint32>(node.TimeoutSeconds);
    this->setPeerHostName(node.Host.c_str());
    this->setPeerPort(static_cast<Uint16>(node.Port));
    this->setPeerAETitle(node.CalledTitle.c_str());
    this->setAETitle(node.CallingTitle.c_str());
    this->setConnectionTimeout(static_cast<Sint32>(seconds));
    this->setACSETimeout(seconds);
    this->setDIMSETimeout(seconds);
    this->setDIMSEBlockingMode(DIMSE_NONBLOCKING);
    dcmSocketSendTimeout.set(node.TimeoutSeconds);
    dcmSocketReceiveTimeout.set(node.TimeoutSeconds);
  }
  ~Association() override
  {
    if (this->isConnected())
    {
      this->closeAssociation(DCMSCU_RELEASE_ASSOCIATION);
    }
  }
  Association(const Association&) = delete;
  Association& operator=(const Association&) = delete;

  void Open()
  {
    if (OFCondition made = this->initNetwork(); made.bad())
    {
      throw NetworkError(NameOf(this->Node) + ": no network (" + ReasonOf(made) + ")");
    }
    if (this->Layer)
    {
      this->useSecureConnection(this->Layer.get());
    }
    if (OFCondition opened = this->negotiateAssociation(); opened.bad())
    {
      throw NetworkError(NameOf(this->Node) + ": expected an association within " +
        std::to_string(this->Node.TimeoutSeconds) + " s, found none (" + ReasonOf(opened) + ")");
    }
  }

protected:
  const DicomNode& Node;
};

OFList<OFString> SyntaxList(std::initializer_list<const char*> syntaxes)
{
  OFList<OFString> list;
  for (const char* syntax : syntaxes)
  {
    list.push_back(syntax);
  }
  return list;
}

void Echo(const DicomNode& node)
{
  Association association(node);
  association.addPresentationContext(UID_VerificationSOPClass,
    SyntaxList({ UID_LittleEndianImplicitTransferSyntax }));
  association.Open();
  if (const OFCondition answered = association.sendECHORequest(0); answered.bad())
  {
    throw NetworkError(
      NameOf(node) + ": expected an answer to C-ECHO, found none (" + ReasonOf(answered) + ")");
  }
}

/// Kinds of objects that a registration can use, or that tell of one.
constexpr const char* FetchedClasses[] = { UID_MRImageStorage, UID_EnhancedMRImageStorage,
  UID_DigitalMammographyXRayImageStorageForPresentation,
  UID_DigitalMammographyXRayImageStorageForProcessing, UID_BreastTomosynthesisImageStorage,
  UID_SegmentationStorage, UID_GrayscaleSoftcopyPresentationStateStorage,
  UID_Comprehensive3DSRStorage, UID_DeformableSpatialRegistrationStorage };

/// Objects may come as they are kept: a context for each syntax, since of one the archive takes one
/// only.
constexpr const char* FetchedSyntaxes[] = { UID_LittleEndianExplicitTransferSyntax,
  UID_LittleEndianImplicitTransferSyntax, UID_JPEGProcess14SV1TransferSyntax,
  UID_JPEGLSLosslessTransferSyntax, UID_JPEG2000LosslessOnlyTransferSyntax,
  UID_JPEG2000TransferSyntax, UID_RLELosslessTransferSyntax, UID_JPEGProcess1TransferSyntax,
  UID_JPEGProcess2_4TransferSyntax, UID_JPEGLSLossyTransferSyntax,
  UID_DeflatedExplicitVRLittleEndianTransferSyntax };

/// Writes what comes, numbered: names of an archive are no names of files here.
class Getter : public Association
{
public:
  Getter(const DicomNode& node, std::string folder, const TellCallback& tell)
    : Association(node)
    , Folder(std::move(folder))
    , Tell(tell)
  {
    this->setStorageMode(DCMSCU_STORAGE_DISK);
  }

  std::size_t Count = 0;
  /// The reason why an object could not be written.
  std::exception_ptr Problem;

protected:
  OFCondition handleSTORERequest(const T_ASC_PresentationContextID /*presID*/,
    DcmDataset* incomingObject, OFBool& continueSession, Uint16& status) override
  {
    std::unique_ptr<DcmDataset> object(incomingObject);
    try
    {
      this->Write(std::move(object));
      status = STATUS_Success;
      ++this->Count;
      this->Tell("object");
    }
    catch (...)
    {
      this->Problem = std::current_exception();
      status = STATUS_STORE_Refused_OutOfResources;
      continueSession = OFFalse;
    }
    return EC_Normal;
  }

private:
  void Write(std::unique_ptr<DcmDataset> object)
  {
    OFString series;
    object->findAndGetOFString(DCM_SeriesInstanceUID, series);
    const auto known = this->Series.try_emplace(series.c_str(), this->Series.size() + 1, 0).first;
    auto& [number, objects] = known->second;
    char name[64];
    std::snprintf(name, sizeof name, "/%03zu", number);
    const std::string folder = this->Folder + name;
    fs::create_directories(folder);
    std::snprintf(name, sizeof name, "/%05zu.dcm", ++objects);
    const E_TransferSyntax syntax = object->getOriginalXfer();
    DcmFileFormat file(object.release(), OFFalse); // which owns it now
    WriteAtomicFile(folder + name,
      [&](const std::string& staged)
      {
        if (const OFCondition saved = file.saveFile(staged.c_str(), syntax); saved.bad())
        {
          throw InputError(folder + name + ": cannot be written (" + ReasonOf(saved) + ")");
        }
      });
  }

  std::string Folder;
  const TellCallback& Tell;
  /// The number of each series, and of its objects so far.
  std::map<std::string, std::pair<std::size_t, std::size_t>> Series;
};

void CheckAccession(const std::string& number)
{
  const bool bad = std::any_of(number.begin(), number.end(),
    [](unsigned char c) { return c < 0x20 || c == '*' || c == '?' || c == '\\' || c == 0x7f; });
  if (number.empty() || number.size() > 16 || bad)
  {
    throw InputError("accession number: expected 1 to 16 characters, without '*', '?' and '\\', of "
                     "one study, found '" +
      number + "'");
  }
}

std::string TextOf(DcmDataset& data, const DcmTagKey& tag)
{
  OFString text;
  data.findAndGetOFStringArray(tag, text);
  return { text.c_str(), text.size() };
}

/// Frees the answers that DCMTK hands over.
template <typename Response>
struct Responses
{
  OFList<Response*> List;
  ~Responses()
  {
    for (Response* response : this->List)
    {
      delete response;
    }
  }
};

/// One study; throws where an object of it is not got.
void GetStudy(Getter& getter, const ArchivedStudy& study, const DicomNode& node)
{
  DcmDataset keys;
  keys.putAndInsertString(DCM_QueryRetrieveLevel, "STUDY");
  keys.putAndInsertString(DCM_StudyInstanceUID, study.StudyInstanceUid.c_str());
  const std::size_t before = getter.Count;
  Responses<RetrieveResponse> responses;
  const OFCondition got = getter.sendCGETRequest(
    getter.findPresentationContextID(UID_GETStudyRootQueryRetrieveInformationModel, ""), &keys,
    &responses.List);
  if (getter.Problem)
  {
    std::rethrow_exception(getter.Problem);
  }
  if (got.bad() || responses.List.empty())
  {
    throw NetworkError(NameOf(node) + ": expected the objects of study " + study.AccessionNumber +
      ", found " + std::to_string(getter.Count - before) + " and then none (" + ReasonOf(got) +
      ")");
  }
  const RetrieveResponse& last = *responses.List.back();
  if (last.m_status != STATUS_Success || last.m_numberOfFailedSubops > 0)
  {
    char status[16];
    std::snprintf(status, sizeof status, "%04x", last.m_status);
    throw NetworkError(NameOf(node) + ": expected all objects of study " + study.AccessionNumber +
      ", found " + std::to_string(getter.Count - before) + ", and " +
      std::to_string(last.m_numberOfFailedSubops) + " that the archive did not give (status " +
      status + "h)");
  }
}

/// "status 0122h", with a word where the standard has one (PS3.4 table B.2-1).
std::string RefusalOfStatus(Uint16 status)
{
  char text[80];
  std::snprintf(text, sizeof text, "status %04xh%s", status,
    status == STATUS_STORE_Refused_SOPClassNotSupported ? ": it does not take this kind of object"
      : (status & 0xff00) == 0xa700                     ? ": out of resources"
      : (status & 0xff00) == 0xa900                     ? ": the object is not of its kind"
      : (status & 0xf000) == 0xc000                     ? ": it does not understand the object"
                                                        : "");
  return text;
}

/// Sends the files and reports each: its path, and after a byte of zero why it is not stored.
void Store(const std::vector<std::string>& files, const DicomNode& node, const TellCallback& tell)
{
  std::vector<FileKind> kinds;
  std::set<std::pair<std::string, std::string>> contexts;
  Association association(node);
  for (const std::string& file : files)
  {
    kinds.push_back(KindOf(file));
    const FileKind& kind = kinds.back();
    if (contexts.emplace(kind.SopClass.c_str(), kind.Syntax.c_str()).second)
    {
      // Uncompressed objects may be sent with explicit or implicit representations.
      const bool plain = kind.Syntax == UID_LittleEndianExplicitTransferSyntax ||
        kind.Syntax == UID_LittleEndianImplicitTransferSyntax;
      association.addPresentationContext(kind.SopClass,
        plain ? SyntaxList({ kind.Syntax.c_str(), UID_LittleEndianExplicitTransferSyntax,
                  UID_LittleEndianImplicitTransferSyntax })
              : SyntaxList({ kind.Syntax.c_str() }));
    }
  }
  if (contexts.size() > 128)
  {
    throw InputError("archive: expected at most 128 kinds of objects at once, found " +
      std::to_string(contexts.size()));
  }
  association.Open();
  std::size_t count = 0;
  std::string refused;
  for (const FileKind& kind : kinds)
  {
    Uint16 status = 0;
    const T_ASC_PresentationContextID context =
      association.findAnyPresentationContextID(kind.SopClass, kind.Syntax);
    const OFCondition sent = context == 0
      ? EC_Normal
      : association.sendSTORERequest(context, kind.Path.c_str(), nullptr, status);
    // Bxxx: stored, with a remark.
    const std::string why = context == 0 ? "it does not take this kind of object"
      : sent.bad()                       ? ReasonOf(sent)
      : status == STATUS_Success || (status & 0xf000) == 0xb000 ? ""
                                                                : RefusalOfStatus(status);
    count += why.empty() ? 1 : 0;
    refused += !refused.empty() || why.empty() ? "" : kind.Path + " (" + why + ")";
    tell(kind.Path + '\0' + why);
    // An object that cannot be sent leaves the connection as it was.
    const bool isOfObject = sent == DIMSE_NOVALIDPRESENTATIONCONTEXTID || sent == DIMSE_BADDATA ||
      sent == NET_EC_InvalidSOPClassUID || sent == NET_EC_InvalidSOPInstanceUID ||
      sent.module() == OFM_dcmdata;
    if (sent.bad() && !(isOfObject && association.isConnected()))
    {
      break;
    }
  }
  if (count < files.size())
  {
    throw NetworkError(NameOf(node) +
      ": expected that it stores all objects, found that it does "
      "not: first " +
      refused + "; stored " + std::to_string(count) + " of " + std::to_string(files.size()));
  }
}

std::vector<ArchivedStudy> Find(const std::string& accessionNumber, const DicomNode& node)
{
  Association association(node);
  association.addPresentationContext(UID_FINDStudyRootQueryRetrieveInformationModel,
    SyntaxList({ UID_LittleEndianExplicitTransferSyntax, UID_LittleEndianImplicitTransferSyntax }));
  association.Open();
  DcmDataset keys;
  keys.putAndInsertString(DCM_QueryRetrieveLevel, "STUDY");
  keys.putAndInsertString(DCM_AccessionNumber, accessionNumber.c_str());
  for (const DcmTagKey& tag :
    { DCM_StudyInstanceUID, DCM_PatientID, DCM_StudyDate, DCM_StudyDescription })
  {
    keys.insertEmptyElement(tag);
  }
  Responses<QRResponse> responses;
  const OFCondition found = association.sendFINDRequest(
    association.findPresentationContextID(UID_FINDStudyRootQueryRetrieveInformationModel, ""),
    &keys, &responses.List);
  if (found.bad() || responses.List.empty() || responses.List.back()->m_status != STATUS_Success)
  {
    throw NetworkError(NameOf(node) + ": expected an answer to the search for accession number " +
      accessionNumber + ", found none (" + ReasonOf(found) + ")");
  }
  std::vector<ArchivedStudy> studies;
  for (QRResponse* response : responses.List)
  {
    if (DcmDataset* data = response->m_dataset)
    {
      ArchivedStudy study{ TextOf(*data, DCM_StudyInstanceUID), TextOf(*data, DCM_AccessionNumber),
        TextOf(*data, DCM_PatientID), TextOf(*data, DCM_StudyDate),
        TextOf(*data, DCM_StudyDescription) };
      // An archive that does not know the key gives all it has.
      if (study.AccessionNumber == accessionNumber && !study.StudyInstanceUid.empty())
      {
        studies.push_back(std::move(study));
      }
    }
  }
  if (studies.empty())
  {
    throw InputError(
      NameOf(node) + ": expected a study of accession number " + accessionNumber + ", found none");
  }
  if (std::any_of(studies.begin(), studies.end(),
        [&](const ArchivedStudy& study) { return study.PatientId != studies.front().PatientId; }))
  {
    throw InputError(NameOf(node) + ": expected one patient with the accession number " +
      accessionNumber + ", found several");
  }
  return studies;
}

/// Writes the studies' objects to the folder and reports each.
void Get(const std::vector<ArchivedStudy>& studies, const DicomNode& node,
  const std::string& folder, const TellCallback& tell)
{
  Getter getter(node, folder, tell);
  getter.addPresentationContext(UID_GETStudyRootQueryRetrieveInformationModel,
    SyntaxList({ UID_LittleEndianExplicitTransferSyntax, UID_LittleEndianImplicitTransferSyntax }));
  for (const char* kind : FetchedClasses)
  {
    for (const char* syntax : FetchedSyntaxes)
    {
      getter.addPresentationContext(kind, SyntaxList({ syntax }), ASC_SC_ROLE_SCP);
    }
  }
  getter.Open();
  for (const ArchivedStudy& study : studies)
  {
    GetStudy(getter, study, node);
  }
  if (getter.Count == 0)
  {
    throw NetworkError(NameOf(node) + ": expected objects of the studies, found none");
  }
}
}

void SetAddress(DicomNode& node, const std::string& hostAndPort)
{
  const auto colon = hostAndPort.rfind(':');
  std::string host = hostAndPort.substr(0, colon == std::string::npos ? 0 : colon);
  int port = 0;
  const char* end = hostAndPort.data() + hostAndPort.size();
  const auto parsed = colon == std::string::npos
    ? std::from_chars_result{ end, std::errc::invalid_argument }
    : std::from_chars(hostAndPort.data() + colon + 1, end, port);
  if (host.starts_with('[') && host.ends_with(']'))
  {
    host = host.substr(1, host.size() - 2);
  }
  else if (host.find(':') != std::string::npos)
  {
    host.clear();
  }
  if (host.empty() || parsed.ec != std::errc() || parsed.ptr != end || port < 1 || port > 65535)
  {
    throw InputError("archive: expected HOST:PORT, found '" + hostAndPort + "'");
  }
  node.Host = host;
  node.Port = port;
}

std::vector<std::string> FindDicomFiles(const std::vector<std::string>& paths,
  const StoredCallback& refused)
{
  std::vector<std::string> files;
  for (const std::string& path : paths)
  {
    std::error_code problem;
    if (!fs::exists(path, problem))
    {
      throw InputError(path + ": no such file");
    }
    if (!fs::is_directory(path, problem))
    {
      files.push_back(path);
      continue;
    }
    std::vector<std::string> within;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(path))
    {
      if (entry.is_regular_file())
      {
        within.push_back(entry.path());
      }
    }
    std::sort(within.begin(), within.end());
    files.insert(files.end(), within.begin(), within.end());
  }
  std::vector<std::string> whole;
  for (const std::string& file : files)
  {
    try
    {
      if (!ReadDicomHeader(file))
      {
        throw InputError(file + ": expected a DICOM file, found another");
      }
      CheckDicomElements(file);
      whole.push_back(file);
    }
    catch (const InputError& error)
    {
      if (!refused)
      {
        throw;
      }
      const std::string why = error.what();
      refused(file, why.starts_with(file + ": ") ? why.substr(file.size() + 2) : why);
    }
  }
  if (whole.empty())
  {
    throw InputError("archive: expected DICOM files to send, found none");
  }
  return whole;
}

void VerifyNode(const DicomNode& node)
{
  TalkTo(node,
    [&](const TellCallback&)
    {
      Echo(node);
      return std::vector<ArchivedStudy>();
    },
    {});
}

void StoreFiles(const std::vector<std::string>& files, const DicomNode& node,
  const StoredCallback& stored, const StopRequest& stop)
{
  const auto checkStop = [&stop]
  {
    if (stop && stop())
    {
      throw Interrupted();
    }
  };
  checkStop();
  std::size_t left = files.size();
  TalkTo(
    node,
    [&](const TellCallback& tell)
    {
      Store(files, node, tell);
      return std::vector<ArchivedStudy>();
    },
    [&](const std::string& file)
    {
      // Stops only between two files, so that every stored file has been reported.
      if (!file.empty())
      {
        const auto end = file.find('\0');
        stored(file.substr(0, end), file.substr(end + 1));
        if (--left > 0)
        {
          checkStop();
        }
      }
    });
}

std::vector<ArchivedStudy> FindStudies(const std::string& accessionNumber, const DicomNode& node)
{
  CheckAccession(accessionNumber);
  return TalkTo(node, [&](const TellCallback&) { return Find(accessionNumber, node); }, {});
}

std::size_t GetStudies(const std::vector<ArchivedStudy>& studies, const DicomNode& node,
  const std::string& folder, const ProgressCallback& progress)
{
  std::size_t count = 0;
  WriteAtomicFolder(folder,
    [&](const std::string& staged)
    {
      count = 0;
      TalkTo(
        node,
        [&](const TellCallback& tell)
        {
          Get(studies, node, staged, tell);
          return std::vector<ArchivedStudy>();
        },
        [&](const std::string& object)
        {
          count += object.empty() ? 0 : 1;
          ReportProgress(progress, 0, "getting objects");
        });
    });
  return count;
}
}
