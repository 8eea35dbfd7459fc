#include "tools/sightline/command_line/output_files.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>

#include "scenes/procedural.h"
#include "sightline/io/file.h"
#include "tools/sightline/command_line/side_files.h"
#include "tools/sightline/command_line/signals.h"

namespace sightline::tool {
namespace {

namespace fs = std::filesystem;

constexpr const char* kScene = "SCENE";

bool isFile(const std::string& name) {
  return !name.empty() && name != "-";
}

bool exists(const std::string& name) {
  std::error_code ignored;
  return fs::exists(name, ignored);
}

bool isFolder(const fs::path& name) {
  std::error_code ignored;
  return fs::is_directory(name, ignored);
}

// The name without links and dots. If the file does not exist, the folders that exist are resolved.
fs::path canonical(const std::string& file) {
  std::error_code ignored;
  return fs::weakly_canonical(fs::absolute(file, ignored), ignored);
}

// A text that is equal for two names of one file: its device and inode or, if the file does not exist, its
// canonical name.
std::string identityOf(const std::string& file) {
  struct stat facts {};
  return ::stat(file.c_str(), &facts) == 0 ? fmt::format("{}:{}", facts.st_dev, facts.st_ino)
                                           : canonical(file).string();
}

// Whether the name is a device, such as /dev/null, which several options may name.
bool isDevice(const std::string& name) {
  std::error_code ignored;
  const fs::file_status status = fs::status(name, ignored);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

std::vector<NamedFile> allOutputs(const CommandFiles& files) {
  std::vector<NamedFile> outputs = files.outputs;
  if (!files.folder.folder.empty()) {
    outputs.push_back({files.folder.option, files.folder.folder});
    for (const std::string& name : files.folder.files) {
      outputs.push_back({files.folder.option, (fs::path(files.folder.folder) / name).string()});
    }
  }
  std::erase_if(outputs, [](const NamedFile& output) { return !isFile(output.file); });
  return outputs;
}

// With side_files, scenes are searched for the files that they name, which takes time.
std::vector<NamedFile> allInputs(const CommandFiles& files, bool side_files) {
  std::vector<NamedFile> inputs = files.inputs;
  for (const std::string& scene : files.scenes) {
    if (isDemoUrl(scene)) {
      continue;
    }
    inputs.push_back({kScene, scene});
    if (side_files) {
      for (const std::string& side_file : sideFilesOf(scene)) {
        inputs.push_back({kScene, side_file});
      }
    }
  }
  std::erase_if(inputs, [](const NamedFile& input) { return !isFile(input.file) || !exists(input.file); });
  return inputs;
}

// Checks the output's name and its folder.
Status checkPlace(const NamedFile& output) {
  const auto& [option, file, extension] = output;
  const fs::path path(file);
  if (file.empty()) {
    return Success{};
  }
  if (!extension.empty() && path.extension() != extension) {
    return Error{fmt::format("{} {}: the file's name must end in {}", option, file, extension)};
  }
  if (!isFile(file)) {
    return Success{};
  }
  if (isFolder(path)) {
    return Error{fmt::format("{} {}: is a folder; give the name of a file", option, file)};
  }
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!isFolder(folder)) {
    return Error{fmt::format("{} {}: there is no folder {}; make it first", option, file, folder.string())};
  }
  return Success{};
}

Status checkFolder(const NamedFolder& folder) {
  if (!folder.folder.empty() && exists(folder.folder) && !isFolder(folder.folder)) {
    return Error{fmt::format("{} {}: is a file; give the name of a folder", folder.option, folder.folder)};
  }
  return Success{};
}

// Being told to end waits until the file is whole.
Status saved(const std::string& file, const std::function<Status()>& write) {
  Status status = Success{};
  {
    const SignalGuard guard;
    status = write();
    if (status) {
      noteWritten(file);
    }
  }
  endIfTold();
  return status;
}

}  // namespace

Status checkFiles(const CommandFiles& files) {
  for (const NamedFile& output : files.outputs) {
    if (const Status ok = checkPlace(output); !ok) {
      return ok;
    }
  }
  if (const Status ok = checkFolder(files.folder); !ok) {
    return ok;
  }
  const std::vector<NamedFile> outputs = allOutputs(files);
  // An output that does not exist yet cannot be an input.
  const bool any_there = std::any_of(outputs.begin(), outputs.end(),
                                     [](const NamedFile& output) { return exists(output.file); });
  std::map<std::string, NamedFile> inputs, written;  // by identityOf
  for (const NamedFile& input : allInputs(files, any_there)) {
    inputs.emplace(identityOf(input.file), input);
  }
  for (const NamedFile& output : outputs) {
    const auto& [option, file, extension] = output;
    const std::string identity = identityOf(file);
    if (const auto same = inputs.find(identity); same != inputs.end()) {
      return Error{fmt::format("{} {}: is the input itself ({} {}); name another output", option, file,
                               same->second.option, same->second.file)};
    }
    const auto [same, is_new] = written.emplace(identity, output);
    if (!is_new && !isDevice(file)) {
      return Error{
          fmt::format("{} {}: is the file of {} too; name another", option, file, same->second.option)};
    }
  }
  return Success{};
}

Status makeFolder(const std::string& folder) {
  std::error_code error;
  std::vector<fs::path> missing;  // the innermost first
  fs::path path = fs::absolute(folder, error).lexically_normal();
  while (!path.empty() && !fs::exists(path, error)) {
    missing.push_back(path);
    path = path.parent_path();
  }
  {
    const SignalGuard guard;
    fs::create_directories(folder, error);
    for (auto made = missing.rbegin(); made != missing.rend(); ++made) {
      removeWhenTold(made->string());
    }
  }
  endIfTold();
  if (!isFolder(folder)) {
    return Error{
        fmt::format("{}: cannot make this folder: {}", folder, error ? error.message() : "a file is there")};
  }
  return Success{};
}

Status saveFile(const std::string& file, std::string_view bytes) {
  return saveFile(file, std::span(&bytes, 1));
}

Status saveFile(const std::string& file, std::span<const std::string_view> pieces) {
  return saved(file, [&] { return writeFile(file, pieces); });
}

Status savePicture(const Image& image, const std::string& file) {
  return saved(file, [&] { return writePng(image, file); });
}

}  // namespace sightline::tool
