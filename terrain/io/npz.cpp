// Reads .npz: the zip format's directory (PKWARE's APPNOTE 6.3), its entries stored or deflated, each a .npy (NumPy's format 1.0 to 3.0).
// Sizes are taken from the directory, checked against the file, and nothing is allocated that deflate could not have packed (1032 to 1).
// Missing: zip64, encryption, structured types, complex numbers, Python objects.
#include "terrain/io/npz.h"

#include "terrain/error.h"
#include "terrain/io/numpy_header.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>

namespace hoodoo
{

namespace
{

constexpr std::uint64_t kMaxFile = 1ull << 30;

[[noreturn]] void refuse(const std::string& path, std::string what, std::string got = {})
{
    throw Error(ErrorKind::file, Problem{{path, 0, 0, {}}, std::move(what), {}, std::move(got), {}});
}

std::uint32_t little(const unsigned char* p, int bytes)
{
    std::uint32_t x = 0;
    for (int i = bytes - 1; i >= 0; --i) x = (x << 8) | p[i];
    return x;
}

std::vector<unsigned char> unpack(const std::string& path, const unsigned char* packed, std::uint64_t packed_size, std::uint64_t size, int method)
{
    if (method == 0) {
        if (packed_size != size) refuse(path, "damaged archive: a stored entry has two sizes");
        return {packed, packed + size};
    }
    if (method != 8) refuse(path, "an entry of the archive is packed in an unknown way", fmt::format("method {}", method));
    if (size > 1032 * packed_size + 64)
        refuse(path, "damaged archive: an entry promises more than it can hold", fmt::format("{} bytes from {}", size, packed_size));
    std::vector<unsigned char> out(size);
    z_stream stream{};
    if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) refuse(path, "cannot start unpacking");
    stream.next_in = const_cast<unsigned char*>(packed);
    stream.avail_in = static_cast<uInt>(packed_size);
    stream.next_out = out.data();
    stream.avail_out = static_cast<uInt>(size);
    const int result = inflate(&stream, Z_FINISH);
    const bool whole = result == Z_STREAM_END && stream.total_out == size;
    inflateEnd(&stream);
    if (!whole) refuse(path, "damaged archive: an entry does not unpack to its size");
    return out;
}

NumpyArray parse_npy(const std::string& path, const std::string& name, const std::vector<unsigned char>& bytes)
{
    const NumpyHeader header = read_numpy_header(path, name, bytes.data(), bytes.size());
    if (bytes.size() - header.data < header.count * header.width) refuse(path, "\"" + name + "\" is cut short");
    NumpyArray array{header.shape, {}};
    array.values.resize(header.count);
    header.convert(bytes.data() + header.data, array.values);
    return array;
}

}  // namespace

NpzFile::NpzFile(const std::string& path) : path_(path)
{
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    const std::streamoff size = file ? static_cast<std::streamoff>(file.tellg()) : -1;
    if (size < 0) refuse(path, "cannot read the archive");
    if (static_cast<std::uint64_t>(size) > kMaxFile) refuse(path, "the archive is larger than 1 GiB");
    bytes_.resize(static_cast<std::size_t>(size));
    file.seekg(0);
    if (!file.read(reinterpret_cast<char*>(bytes_.data()), size)) refuse(path, "cannot read the archive");

    // The end record stands in the last 64 KiB, after it only a comment.
    const std::size_t n = bytes_.size();
    std::size_t end = n;
    for (std::size_t back = 22; back <= std::min<std::size_t>(n, 22 + 65535); ++back) {
        if (little(bytes_.data() + n - back, 4) == 0x06054b50u) {
            end = n - back;
            break;
        }
    }
    if (end == n) refuse(path, "no NumPy archive: it has no zip directory");
    const unsigned count = little(bytes_.data() + end + 10, 2);
    std::size_t at = little(bytes_.data() + end + 16, 4);
    for (unsigned k = 0; k < count; ++k) {
        if (at > n || n - at < 46 || little(bytes_.data() + at, 4) != 0x02014b50u) refuse(path, "damaged archive: its directory");
        const unsigned char* h = bytes_.data() + at;
        const std::size_t name_size = little(h + 28, 2), local = little(h + 42, 4);
        const std::uint64_t packed = little(h + 20, 4), full = little(h + 24, 4);
        if (n - at - 46 < name_size || local > n || n - local < 30) refuse(path, "damaged archive: its directory");
        const std::uint64_t data = local + 30ull + little(bytes_.data() + local + 26, 2) + little(bytes_.data() + local + 28, 2);
        if (data > n || packed > n - data) refuse(path, "damaged archive: an entry reaches beyond the file");
        std::string name(reinterpret_cast<const char*>(h) + 46, name_size);
        if (name.ends_with(".npy")) name.resize(name.size() - 4);
        names_.push_back(std::move(name));
        entries_.push_back({data, packed, full, static_cast<int>(little(h + 10, 2))});
        at += 46 + name_size + little(h + 30, 2) + little(h + 32, 2);
    }
}

bool NpzFile::has(const std::string& name) const
{
    return std::find(names_.begin(), names_.end(), name) != names_.end();
}

NumpyArray NpzFile::read(const std::string& name) const
{
    const auto found = std::find(names_.begin(), names_.end(), name);
    if (found == names_.end()) {
        throw Error(ErrorKind::file, Problem{{path_, 0, 0, {}},
                                             "the archive has no array of this name",
                                             fmt::format("one of: {}", fmt::join(names_, ", ")),
                                             '"' + name + '"',
                                             nearest_name(name, names_)});
    }
    const Entry& entry = entries_[static_cast<std::size_t>(found - names_.begin())];
    return parse_npy(path_, name, unpack(path_, bytes_.data() + entry.offset, entry.packed, entry.size, entry.method));
}

}  // namespace hoodoo
