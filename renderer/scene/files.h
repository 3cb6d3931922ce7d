// Which files a scene may read: those below its own folder and below the roots that the user declared, and nothing else.
#pragma once

#include "terrain/error.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace hoodoo
{

/// The folder names of a scene's sources and the roots. A value: copies may outlive the reader.
class SceneFiles
{
public:
    /// `allowed_roots` are made absolute now. Throws Error(file) if one is no folder.
    explicit SceneFiles(const std::vector<std::string>& allowed_roots);

    /// Paths named in `file` (as it appears in Source::file) are relative to `folder`. Files without a folder (texts, the command line) use the
    /// current one.
    void set_folder(const std::string& file, const std::filesystem::path& folder);
    void allow(const std::filesystem::path& root);

    /// The real path of a regular file named at `where`. Throws Error: `scene` if it lies outside the roots (links are followed first), `file` if it
    /// is absent or no regular file. Opens nothing.
    std::string resolve(const std::string& path, const Source& where) const;

private:
    std::filesystem::path start_;  ///< the current folder while the scene was read
    std::vector<std::filesystem::path> roots_;
    std::map<std::string, std::filesystem::path> folders_;
};

/// The bytes of a regular file of at most `limit` bytes. Never waits for a pipe. Throws Error(file), Error(scene) if it is longer.
std::string read_regular_file(const std::string& path, std::size_t limit, const Source& where);

}  // namespace hoodoo
