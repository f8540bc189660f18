#include "tests/faults/fault_sweep.h"

#include <signal.h>

#include <algorithm>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <ostream>
#include <random>
#include <stdexcept>

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "tests/cli/cli_runner.h"
#include "tests/cli/database_tables.h"
#include "tests/cli/synthetic_strip.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;
using Files = std::map<std::string, std::string>;  // name -> what it holds

struct FaultKind {
  const char* name;
  std::set<SystemCall> calls;
  FaultAction action = FaultAction::kFail;
  int error_number = 0;
  bool is_lasting = false;
};

const std::set<SystemCall> kChanges = {
    SystemCall::kOpenToWrite, SystemCall::kWrite,  SystemCall::kResize,    SystemCall::kSync,
    SystemCall::kRename,      SystemCall::kRemove, SystemCall::kMakeFolder};

const std::vector<FaultKind>& FaultKinds() {
  using Call = SystemCall;
  static const std::vector<FaultKind> kinds = {
      {"no space for a write", {Call::kWrite}, FaultAction::kFail, ENOSPC},
      {"no space any more", kChanges, FaultAction::kFail, ENOSPC, true},
      {"a write fails", {Call::kWrite}, FaultAction::kFail, EIO},
      {"a short write", {Call::kWrite}, FaultAction::kShorten},
      {"a resize fails", {Call::kResize}, FaultAction::kFail, EIO},
      {"a sync fails", {Call::kSync}, FaultAction::kFail, EIO},
      {"no space for a file", {Call::kOpenToWrite}, FaultAction::kFail, ENOSPC},
      {"no descriptor to write", {Call::kOpenToWrite}, FaultAction::kFail, EMFILE},
      {"no permission to write", {Call::kOpenToWrite}, FaultAction::kFail, EACCES},
      {"no descriptor to read", {Call::kOpenToRead}, FaultAction::kFail, EMFILE},
      {"no permission to read", {Call::kOpenToRead}, FaultAction::kFail, EACCES},
      {"a read fails", {Call::kRead}, FaultAction::kFail, EIO},
      {"no read any more", {Call::kRead}, FaultAction::kFail, EIO, true},
      {"a short read", {Call::kRead}, FaultAction::kShorten},
      {"a rename fails", {Call::kRename}, FaultAction::kFail, EIO},
      {"no permission to remove", {Call::kRemove}, FaultAction::kFail, EACCES},
      {"no space for a folder", {Call::kMakeFolder}, FaultAction::kFail, ENOSPC},
      {"no memory to map", {Call::kMap}, FaultAction::kFail, ENOMEM},
      {"no thread or process", {Call::kStart}, FaultAction::kFail, EAGAIN},
      {"killed", kChanges, FaultAction::kKill},
  };
  return kinds;
}

struct SweptCommand {
  std::string name;
  // Of the folders "in" and "work"; all that is written lies in "work".
  std::function<Arguments(const std::string& in, const std::string& work)> arguments;
  const char* initial_database = nullptr;  // in "in"; becomes work/d.db
};

const std::vector<SweptCommand>& Commands() {
  static const Arguments few_seapoints = {"--SeaPointExtraction.min_num_features", "300",
                                          "--SeaPointExtraction.max_num_features", "400"};
  static const auto with_few = [](Arguments arguments) {
    arguments.insert(arguments.end(), few_seapoints.begin(), few_seapoints.end());
    return arguments;
  };
  static const std::vector<SweptCommand> commands = {
      {"feature_extractor",
       [](const auto& in, const auto& work) {
         return with_few({"--database_path", work + "/d.db", "--image_path", in + "/images"});
       }},
      {"exhaustive_matcher",
       [](const auto&, const auto& work) -> Arguments {
         return {"--database_path", work + "/d.db"};
       },
       "features.db"},
      {"partial_densifier",
       [](const auto& in, const auto& work) {
         return with_few({"--image_path", in + "/images", "--input_path", in + "/model",
                          "--output_path", work + "/dense", "--PartialDensification.step", "4"});
       }},
      {"orthomosaic",
       [](const auto& in, const auto& work) -> Arguments {
         return {"--image_path", in + "/images",          "--input_path",  in + "/model",
                 "--cloud_path", in + "/dense/fused.ply", "--output_path", work + "/map"};
       }},
      {"model_scaler",
       [](const auto& in, const auto& work) -> Arguments {
         return {"--input_path",     in + "/model",        "--output_path",
                 work + "/scaled",   "--cloud_path",       in + "/dense/fused.ply",
                 "--positions_path", in + "/positions.csv"};
       }},
      {"cloud_comparer",
       [](const auto& in, const auto& work) -> Arguments {
         return {"--input_path",      in + "/dense/fused.ply", "--reference_path",
                 in + "/cloud.ply",   "--output_path",         work + "/c.json",
                 "--difference_path", work + "/difference"};
       }},
      {"automatic_reconstructor",
       [](const auto& in, const auto& work) {
         return with_few({"--image_path", in + "/images", "--workspace_path", work + "/ws",
                          "--colmap_path", FAKE_COLMAP, "--PartialDensification.step", "4"});
       }},
  };
  return commands;
}

// Of our files in a folder: it names them before they are there, and some that are gone.
bool IsNameList(const fs::path& path) { return path.filename() == ".colmap_seapoint"; }

// COLMAP is asked more often when it has failed.
bool IsLog(const fs::path& path) { return path.extension() == ".log"; }

// What holds no times, and is not written bit by bit.
bool IsSameEachTime(const fs::path& path) {
  const std::string name = path.filename().string();
  constexpr char kReport[] = "run.json";
  const bool is_report = name.size() >= sizeof(kReport) - 1 &&
                         name.compare(name.size() - (sizeof(kReport) - 1), name.npos, kReport) == 0;
  return !is_report && !IsNameList(path) && name != "pairs.csv" && name != "summary.txt" &&
         name != "index.html" && !IsLog(path) && path.parent_path().filename() != "state";
}

// What lies there while a run is at work only.
bool IsInUse(const fs::path& path) {
  const std::string extension = path.extension().string();
  const bool is_temporary = path.filename().string().rfind(".seapoint_", 0) == 0;
  return is_temporary || extension == ".lock" || extension == ".db-wal" || extension == ".db-shm";
}

// One command on three pictures, again and again.
class Sweep {
 public:
  explicit Sweep(const SweptCommand& command) : command_(command) {
    MakeInputs();
    expected_ = FilesOfCleanRun();
    std::vector<std::string> findings;
    Prepare();
    if (Run({}).exit_code == 0) CheckWhole("in the second of two runs ", false, &findings);
    for (const std::string& finding : findings) throw std::runtime_error(finding);
  }

  // At how many calls of a run faults of this kind can be.
  int CountCalls(const FaultKind& kind) {
    Fault fault = FaultOf(kind, 0);
    fault.max_hits = 0;
    Prepare();
    return Run(fault).faults.num_calls;
  }

  void Try(const FaultKind& kind, int call, FaultSweepFigures* figures) {
    Prepare();
    const CliResult result = Run(FaultOf(kind, call));
    if (result.faults.num_hits == 0) return;  // threads: other calls each time
    const bool is_kill = kind.action == FaultAction::kKill;
    ++(is_kill ? figures->num_kills : figures->num_faults);
    figures->num_done += !is_kill && result.exit_code == 0;
    figures->num_failed += !is_kill && result.exit_code == 1;
    figures->num_incomplete += !is_kill && result.exit_code == 3;
    std::vector<std::string> findings;
    CheckEnd(kind, result, &findings);
    CheckHalfFiles(result, &findings);
    if (!MayLeave(kind)) CheckLeftovers(&findings);
    if (result.exit_code != 0 || MayLeave(kind)) {
      const CliResult rerun = Run({});
      if (rerun.exit_code != 0) {
        findings.push_back("the next run fails: " + rerun.LastErrorLine());
      } else {
        // A picture that comes later gets a later number.
        const bool has_other_ids = result.exit_code == 3 && command_.name == "feature_extractor";
        if (!has_other_ids) CheckWhole("after the next run ", false, &findings);
      }
    }
    for (const std::string& finding : findings) {
      figures->complaints.push_back(command_.name + ", " + kind.name + ", call " +
                                    std::to_string(call) + " (" + result.faults.first_hit +
                                    "), exit code " + std::to_string(result.exit_code) + ": " +
                                    finding + " | " + result.LastErrorLine());
    }
  }

 private:
  std::string In() const { return (folder_ / "in").string(); }
  std::string Work() const { return (folder_ / "work").string(); }

  void MakeInputs() {
    constexpr int kNumPictures = 3;
    WriteStrip(In() + "/images", kNumPictures);
    WriteSparseModelBinary(In() + "/model", StripModel(kNumPictures));
    WriteBytes(In() + "/positions.csv",
               "image,x,y,z\nimg1.png,0,0,0\nimg2.png,1,0,0\nimg3.png,2,0.1,0\n");
    RunOther("partial_densifier", "dense", In() + "/dense");
    fs::copy_file(In() + "/dense/fused.ply", In() + "/cloud.ply");
    RunOther("feature_extractor", "d.db", In() + "/features.db");
  }

  // What another command makes is an input of this one.
  void RunOther(const std::string& name, const std::string& output, const std::string& to) {
    const auto command = std::find_if(Commands().begin(), Commands().end(),
                                      [&](const SweptCommand& c) { return c.name == name; });
    Arguments arguments = command->arguments(In(), Work());
    arguments.insert(arguments.begin(), name);
    fs::remove_all(Work());
    fs::create_directories(Work());
    const CliResult result = RunProgram(SEAPOINT_PROGRAM, arguments);
    if (result.exit_code != 0) throw std::runtime_error(result.Text());
    fs::rename(Work() + "/" + output, to);
  }

  void Prepare() {
    fs::remove_all(Work());
    fs::create_directories(Work());
    if (command_.initial_database == nullptr) return;
    fs::copy_file(In() + "/" + command_.initial_database, Work() + "/d.db");
  }

  Fault FaultOf(const FaultKind& kind, int call) const {
    Fault fault;
    fault.calls = kind.calls;
    fault.path_begin = folder_.Path().string();
    fault.num_calls_before = call;
    if (!kind.is_lasting) fault.max_hits = 1;
    fault.action = kind.action;
    fault.error_number = kind.error_number;
    return fault;
  }

  CliResult Run(const std::optional<Fault>& fault) const {
    CliOptions options;
    options.fault = fault;
    Arguments arguments = command_.arguments(In(), Work());
    arguments.insert(arguments.begin(), command_.name);
    arguments.insert(arguments.end(), {"--num_threads", "2"});
    return RunProgram(SEAPOINT_PROGRAM, arguments, options);
  }

  // Of databases the rows: where they lie in the file depends on how often it was opened.
  Files WorkFiles() const {
    Files files;
    for (auto& [name, bytes] : ReadTree(Work())) {
      const fs::path path = fs::path(Work()) / name;
      files[name] = path.extension() == ".db" ? TextOfDatabase(path) : bytes;
    }
    return files;
  }

  static std::string TextOfDatabase(const fs::path& path) {
    std::string text;
    for (const auto& [table, rows] : ReadTables(path)) {
      for (const std::string& row : rows) text += table + ": " + row + "\n";
    }
    return text;
  }

  Files FilesOfCleanRun() {
    Prepare();
    const CliResult result = Run({});
    if (result.exit_code != 0) throw std::runtime_error(result.Text());
    return WorkFiles();
  }

  void CheckEnd(const FaultKind& kind, const CliResult& result,
                std::vector<std::string>* findings) const {
    const std::string last = result.LastErrorLine();
    if (result.timed_out) {
      findings->push_back("hangs");
    } else if (kind.action == FaultAction::kKill) {
      if (result.signal_number != SIGKILL) findings->push_back("survives");
    } else if (result.exit_code == 1) {
      if (last.rfind("error: ", 0) != 0) findings->push_back("ends without an error");
      if (last.find("internal") != std::string::npos) findings->push_back("blames us");
    } else if (result.exit_code == 3) {
      if (result.err.find("left out") == std::string::npos) findings->push_back("leaves out what?");
    } else if (result.exit_code == 0) {
      CheckWhole("", MayLeave(kind), findings);
    } else {
      findings->push_back("ends by signal " + std::to_string(result.signal_number));
    }
  }

  // Whether it is not possible, or too late, to clear away what was in use; the next run does it.
  static bool MayLeave(const FaultKind& kind) {
    return kind.action == FaultAction::kKill || kind.calls.count(SystemCall::kRemove) > 0;
  }

  void CheckWhole(const std::string& when, bool may_leave,
                  std::vector<std::string>* findings) const {
    const Files files = WorkFiles();
    for (const auto& [name, content] : files) {
      if (expected_.count(name) > 0 || IsLog(name) || (may_leave && IsInUse(name))) continue;
      findings->push_back(when + name + " is a stray file");
    }
    for (const auto& [name, content] : expected_) {
      const auto file = files.find(name);
      if (file == files.end()) {
        if (!IsLog(name)) findings->push_back(when + name + " is missing");
      } else if (IsSameEachTime(name) && file->second != content) {
        findings->push_back(when + name + " differs");
      }
    }
  }

  // A COLMAP that dies leaves what it had begun, in a folder that the next run begins anew.
  void CheckLeftovers(std::vector<std::string>* findings) const {
    for (const auto& [name, bytes] : ReadTree(Work())) {
      if (fs::path(name).extension() != ".tmp" || name.find("sparse.tmp/") != std::string::npos) {
        continue;
      }
      findings->push_back("leaves " + name);
    }
  }

  // Of a run that did not end well. What was left out may be missing in the files of one that says
  // so.
  void CheckHalfFiles(const CliResult& result, std::vector<std::string>* findings) const {
    if (result.exit_code == 0) return;
    for (const auto& [name, bytes] : ReadTree(Work())) {
      const fs::path path = fs::path(Work()) / name;
      const auto whole = expected_.find(name);
      if (whole == expected_.end()) continue;
      if (IsNameList(name)) {
        if (bytes.empty() || bytes.back() != '\n') findings->push_back(name + " is half a file");
      } else if (path.extension() == ".db") {
        if (!Unsound(path).empty()) findings->push_back(name + " is damaged");
      } else if (path.extension() == ".json") {
        if (!nlohmann::json::accept(bytes)) findings->push_back(name + " is half a file");
      } else if (IsSameEachTime(name) && result.exit_code != 3 && bytes != whole->second) {
        findings->push_back(name + " is half a file");
      }
    }
  }

  const SweptCommand command_;
  TemporaryFolder folder_;
  Files expected_;
};

}  // namespace

const std::vector<std::string>& SweptCommands() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> result;
    for (const SweptCommand& command : Commands()) result.push_back(command.name);
    return result;
  }();
  return names;
}

FaultSweepFigures SweepFaults(const std::string& command, int stride, unsigned seed,
                              std::ostream* log) {
  const auto swept = std::find_if(Commands().begin(), Commands().end(),
                                  [&](const SweptCommand& c) { return c.name == command; });
  if (swept == Commands().end()) throw std::runtime_error("no such command: " + command);
  Sweep sweep(*swept);
  std::mt19937 random(seed);
  FaultSweepFigures figures;
  for (const FaultKind& kind : FaultKinds()) {
    const int num_calls = sweep.CountCalls(kind);
    figures.num_calls += num_calls;
    const size_t num_complaints = figures.complaints.size();
    const auto first = static_cast<int>(
        random() % static_cast<unsigned>(std::max(1, std::min(stride, num_calls))));
    for (int call = first; call < num_calls; call += stride) {
      sweep.Try(kind, call, &figures);
    }
    if (log == nullptr) continue;
    *log << command << ", " << kind.name << ": " << num_calls << " calls\n";
    for (size_t i = num_complaints; i < figures.complaints.size(); ++i) {
      *log << "  " << figures.complaints[i] << "\n";
    }
    log->flush();
  }
  return figures;
}

}  // namespace colmap_seapoint
