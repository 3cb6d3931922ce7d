// The format of .npy files, versions 1.0 to 3.0: six magic bytes, the version, the header's length, a Python dictionary, the numbers.
// Only what is needed of the dictionary is read: three keys, by their places. Missing: structured types, complex numbers, Python objects.
#include "terrain/io/numpy_header.h"

#include "terrain/error.h"

#include <algorithm>
#include <cstring>

namespace hoodoo
{

namespace
{

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

/// What follows `'key':` in the header's Python dictionary.
std::string entry_of(const std::string& header, const std::string& key)
{
    const std::size_t at = header.find('\'' + key + '\'');
    const std::size_t colon = at == std::string::npos ? at : header.find(':', at);
    if (colon == std::string::npos) return {};
    const std::size_t begin = header.find_first_not_of(' ', colon + 1);
    if (begin == std::string::npos) return {};
    const std::size_t end = header[begin] == '(' ? header.find(')', begin) : header.find(',', begin);
    return header.substr(begin, end == std::string::npos ? end : end - begin + (header[begin] == '(' ? 1 : 0));
}

template <class T>
double number_at(const unsigned char* p, bool swap)
{
    unsigned char bytes[sizeof(T)];
    std::memcpy(bytes, p, sizeof(T));
    if (swap) std::reverse(bytes, bytes + sizeof(T));
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return static_cast<double>(value);
}

using Reader = double (*)(const unsigned char*, bool);

Reader reader_of(const std::string& type, std::size_t& width)
{
    const auto is = [&](const char* name, std::size_t bytes) { return type == name ? (width = bytes, true) : false; };
    if (is("b1", 1)) return number_at<std::uint8_t>;
    if (is("i1", 1)) return number_at<std::int8_t>;
    if (is("u1", 1)) return number_at<std::uint8_t>;
    if (is("i2", 2)) return number_at<std::int16_t>;
    if (is("u2", 2)) return number_at<std::uint16_t>;
    if (is("i4", 4)) return number_at<std::int32_t>;
    if (is("u4", 4)) return number_at<std::uint32_t>;
    if (is("i8", 8)) return number_at<std::int64_t>;
    if (is("u8", 8)) return number_at<std::uint64_t>;
    if (is("f4", 4)) return number_at<float>;
    if (is("f8", 8)) return number_at<double>;
    return nullptr;
}

}  // namespace

void NumpyHeader::convert(const unsigned char* from, std::span<double> to) const
{
    for (double& value : to) {
        value = read(from, swapped);
        from += width;
    }
}

NumpyHeader read_numpy_header(const std::string& path, const std::string& name, const unsigned char* bytes, std::size_t size, std::uint64_t most)
{
    if (size < 12 || std::memcmp(bytes, "\x93NUMPY", 6) != 0) refuse(path, "\"" + name + "\" is no NumPy array");
    const std::size_t prefix = bytes[6] == 1 ? 10 : 12, length = little(bytes + 8, bytes[6] == 1 ? 2 : 4);
    if (length > size - prefix) refuse(path, "\"" + name + "\" is cut short");
    const std::string header(reinterpret_cast<const char*>(bytes) + prefix, length);
    const std::string type = entry_of(header, "descr"), order = entry_of(header, "fortran_order"), shape = entry_of(header, "shape");
    NumpyHeader head;
    head.read = type.size() == 5 ? reader_of(type.substr(2, 2), head.width) : nullptr;
    if (!head.read || shape.empty()) refuse(path, "\"" + name + "\" has a type that is no plain number", type);
    head.data = prefix + length;
    head.swapped = type[1] == '>';
    for (std::size_t i = 0; i < shape.size();) {
        if (shape[i] < '0' || shape[i] > '9') {
            ++i;
            continue;
        }
        std::uint64_t n = 0;
        for (; i < shape.size() && shape[i] >= '0' && shape[i] <= '9'; ++i)
            n = std::min<std::uint64_t>(n * 10 + static_cast<unsigned>(shape[i] - '0'), most + 1);
        head.shape.push_back(n);
        head.count *= n;
        if (head.count > most || n > most || head.shape.size() > 8) refuse(path, "\"" + name + "\" is too large", shape);
    }
    if (order == "True" && head.shape.size() > 1) refuse(path, "\"" + name + "\" is stored column by column (Fortran order); save it in C order");
    return head;
}

}  // namespace hoodoo
