// Which files a scene may read. A scene comes from strangers, like a document: it must not read /proc, hang on a pipe, or follow a link out of its
// folder. The real path is compared with the real roots, component by component, before anything is opened; what is outside is refused whether it
// exists or not. Missing: a link that is swapped between this check and the opening (that needs openat2 in every library that opens files).
#include "renderer/scene/files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace hoodoo
{
namespace fs = std::filesystem;
namespace
{

[[noreturn]] void fail(ErrorKind kind, const Source& where, std::string what, std::string expected = {})
{
    throw Error(kind, Problem{where, std::move(what), std::move(expected), {}, {}});
}

bool lies_below(const fs::path& path, const fs::path& root)
{
    const auto [in_root, rest] = std::mismatch(root.begin(), root.end(), path.begin(), path.end());
    return in_root == root.end();
}

/// Closes a descriptor on every way out.
struct Descriptor {
    int fd;
    ~Descriptor()
    {
        if (fd >= 0) ::close(fd);
    }
};

}  // namespace

SceneFiles::SceneFiles(const std::vector<std::string>& allowed_roots) : start_(fs::current_path())
{
    for (const std::string& root : allowed_roots) {
        std::error_code error;
        const fs::path real = fs::canonical(root, error);
        if (error || !fs::is_directory(real, error)) fail(ErrorKind::file, {}, fmt::format("cannot allow reading from \"{}\": no such folder", root));
        allow(real);
    }
}

void SceneFiles::set_folder(const std::string& file, const fs::path& folder)
{
    folders_[file] = folder;
}

void SceneFiles::allow(const fs::path& root)
{
    roots_.push_back(root);
}

std::string SceneFiles::resolve(const std::string& path, const Source& where) const
{
    if (path.empty() || path.find('\0') != std::string::npos) fail(ErrorKind::scene, where, "this is no path", "the name of a file");
    const auto folder = folders_.find(where.file);
    const fs::path asked = (folder != folders_.end() ? folder->second : start_) / path;  // an absolute path replaces the folder
    std::error_code error;
    const fs::path real = fs::weakly_canonical(asked, error);
    if (error) fail(ErrorKind::file, where, fmt::format("cannot open \"{}\": {}", path, error.message()));
    if (std::none_of(roots_.begin(), roots_.end(), [&](const fs::path& root) { return lies_below(real, root); }))
        fail(ErrorKind::scene, where, fmt::format("\"{}\" lies outside the folders this scene may read", path),
             "a file below the scene's own folder, or --allow-read FOLDER");
    const fs::file_status status = fs::status(real, error);
    if (!fs::exists(status)) fail(ErrorKind::file, where, fmt::format("cannot open \"{}\": no such file", path));
    if (!fs::is_regular_file(status)) fail(ErrorKind::file, where, fmt::format("\"{}\" is not a regular file", path));
    return real.string();
}

std::string read_regular_file(const std::string& path, std::size_t limit, const Source& where)
{
    // Without O_NONBLOCK the opening of a pipe would wait for a writer.
    const Descriptor file{::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY)};
    struct stat status {
    };
    if (file.fd < 0 || ::fstat(file.fd, &status) != 0)
        fail(ErrorKind::file, where, fmt::format("cannot open \"{}\": {}", path, std::strerror(errno)));
    if (!S_ISREG(status.st_mode)) fail(ErrorKind::file, where, fmt::format("\"{}\" is not a regular file", path));
    if (static_cast<std::uintmax_t>(status.st_size) > limit)
        fail(ErrorKind::scene, where, fmt::format("\"{}\" is too long", path), "at most 64 MB with its includes");
    std::string bytes(static_cast<std::size_t>(status.st_size), '\0');
    std::size_t got = 0;
    while (got < bytes.size()) {
        const ssize_t n = ::read(file.fd, bytes.data() + got, bytes.size() - got);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) fail(ErrorKind::file, where, fmt::format("cannot read \"{}\": {}", path, std::strerror(errno)));
        if (n == 0) break;
        got += static_cast<std::size_t>(n);
    }
    bytes.resize(got);
    return bytes;
}

}  // namespace hoodoo
