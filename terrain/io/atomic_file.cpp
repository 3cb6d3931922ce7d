// Write under a temporary name, force it to the disk, read it back, rename, force the folder to the disk.
//
// Existence of a file is no proof of its content: image libraries have reported success for files cut off by a full disk. So every byte passes
// through our own write(), whose errors are kept even if the library that calls it swallows them in a destructor, and nothing gets its name before it
// was decoded from the disk. A process that is killed in between leaves a file named .NAME.*.tmp, never a partial NAME.
#include "terrain/io/atomic_file.h"

#include "terrain/error.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <random>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace hoodoo
{

namespace
{

[[noreturn]] void fail(const std::string& path, const char* what, const std::string& why)
{
    throw Error(ErrorKind::file, fmt::format("the file \"{}\" cannot be {}: {}", path, what, why));
}

std::string reason(int error)
{
    return std::generic_category().message(error);
}

/// Owns the temporary file: closes and removes it unless it got its name.
class Temporary
{
public:
    Temporary(const std::string& path, const std::filesystem::path& folder, const std::string& name)
    {
        std::random_device random;
        do {
            path_ = (folder / fmt::format(".{}.{:08x}.tmp", name, random())).string();
            descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        } while (descriptor_ < 0 && errno == EEXIST);
        if (descriptor_ < 0) fail(path, "created", reason(errno));
    }
    Temporary(const Temporary&) = delete;
    Temporary& operator=(const Temporary&) = delete;
    ~Temporary()
    {
        close();
        if (!renamed_) ::unlink(path_.c_str());
    }

    int descriptor() const { return descriptor_; }
    const std::string& path() const { return path_; }
    bool close()
    {
        const int descriptor = std::exchange(descriptor_, -1);
        return descriptor < 0 || ::close(descriptor) == 0;
    }
    bool rename_to(const std::string& path) { return renamed_ = ::rename(path_.c_str(), path.c_str()) == 0; }

private:
    std::string path_;
    int descriptor_ = -1;
    bool renamed_ = false;
};

void sync_folder(const std::string& path, const std::filesystem::path& folder)
{
    const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) fail(path, "made permanent", reason(errno));
    const int error = ::fsync(descriptor) == 0 ? 0 : errno;
    ::close(descriptor);
    if (error != 0 && error != EINVAL) fail(path, "made permanent", reason(error));  // EINVAL: a file system whose folders need no fsync
}

}  // namespace

void ByteSink::check(bool success)
{
    if (!success && error_ == 0) error_ = errno;
    if (error_ != 0) throw std::system_error(error_, std::generic_category());
}

void ByteSink::write(const void* bytes, std::size_t count)
{
    check(true);
    const char* next = static_cast<const char*>(bytes);
    while (count > 0) {
        const ssize_t written = ::write(descriptor_, next, count);
        if (written < 0 && errno == EINTR) continue;
        check(written >= 0);
        next += written;
        count -= static_cast<std::size_t>(written);
        position_ += static_cast<std::uint64_t>(written);
    }
}

void ByteSink::seek(std::uint64_t position)
{
    check(::lseek(descriptor_, static_cast<off_t>(position), SEEK_SET) >= 0);
    position_ = position;
}

void write_atomically(const std::string& path, const std::function<void(ByteSink&)>& produce, const std::function<void(const std::string&)>& verify)
{
    // Only a regular file may be replaced: renaming over a device or a pipe would destroy it.
    struct stat status;
    if (::lstat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISLNK(status.st_mode)) fail(path, "replaced", "it is no regular file");
    const std::filesystem::path name(path);
    const std::filesystem::path folder = name.has_parent_path() ? name.parent_path() : std::filesystem::path(".");
    Temporary temporary(path, folder, name.filename().string());

    ByteSink sink(temporary.descriptor());
    try {
        produce(sink);
    } catch (const std::exception& failure) {
        fail(path, "written", sink.error() != 0 ? reason(sink.error()) : failure.what());
    }
    if (sink.error() != 0) fail(path, "written", reason(sink.error()));
    if (::fsync(temporary.descriptor()) != 0) fail(path, "written", reason(errno));
    if (!temporary.close()) fail(path, "written", reason(errno));
    try {
        verify(temporary.path());
    } catch (const std::exception& failure) {
        fail(path, "read back as it was written", failure.what());
    }
    if (!temporary.rename_to(path)) fail(path, "given its name", reason(errno));
    sync_folder(path, folder);
}

}  // namespace hoodoo
