// A file that appears whole or not at all.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace hoodoo
{

/// Where the bytes go while the file has no name yet. Throws once anything failed, and remembers it: a library that swallows the exception cannot
/// hide it.
class ByteSink
{
public:
    explicit ByteSink(int descriptor) : descriptor_(descriptor) {}
    void write(const void* bytes, std::size_t count);
    void seek(std::uint64_t position);
    std::uint64_t tell() const { return position_; }
    int error() const { return error_; }  ///< errno of the first failure, 0 if none

private:
    int descriptor_;
    int error_ = 0;
    std::uint64_t position_ = 0;
    void check(bool success);
};

/// Replaces `path` in one step by what `produce` writes, after `verify` has read the temporary file (in the same folder) from the disk and found in
/// it what was meant: it throws if not. A reader of `path` sees the old file or the new one, complete; after a failure the old one, and no temporary
/// file is left. Throws Error (file). Refuses to replace anything but a regular file.
void write_atomically(const std::string& path, const std::function<void(ByteSink&)>& produce,
                      const std::function<void(const std::string& temporary)>& verify);

}  // namespace hoodoo
