// PLY and OBJ, written in one pass without ever holding the mesh.
// PLY wants the number of vertices first and all triangles last: triangles wait in a file without a name in the same folder, and the header is
// written again at the end, at its first length (a comment takes up the slack). OBJ may mix vertices and triangles, so parts follow one another. The
// check after writing reads the header and the size: every byte passed through our own write().
#include "terrain/io/mesh_writer.h"

#include "terrain/error.h"
#include "terrain/io/atomic_file.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <unistd.h>

namespace hoodoo
{

namespace
{

static_assert(std::endian::native == std::endian::little, "PLY files are written as this processor's bytes");

/// Bytes that wait. Throws std::runtime_error.
class Spool
{
public:
    explicit Spool(const std::string& beside)
    {
        const std::filesystem::path folder = std::filesystem::path(beside).parent_path();
        std::string name = ((folder.empty() ? "." : folder) / ".triangles.XXXXXX").string();
        const int descriptor = ::mkstemp(name.data());
        if (descriptor >= 0) ::unlink(name.c_str());
        file_ = descriptor >= 0 ? ::fdopen(descriptor, "w+b") : nullptr;
        if (!file_) throw std::runtime_error(std::strerror(errno));
    }
    Spool(const Spool&) = delete;
    Spool& operator=(const Spool&) = delete;
    ~Spool() { std::fclose(file_); }

    void write(const std::string& bytes)
    {
        if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) throw std::runtime_error(std::strerror(errno));
    }
    void copy_to(ByteSink& sink)
    {
        if (std::fflush(file_) != 0 || std::fseek(file_, 0, SEEK_SET) != 0) throw std::runtime_error(std::strerror(errno));
        std::array<char, 65536> buffer;
        while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), file_)) sink.write(buffer.data(), n);
        if (std::ferror(file_)) throw std::runtime_error("the triangles cannot be read back");
    }

private:
    std::FILE* file_;
};

template <class T>
void append(std::string& bytes, T value)
{
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string ply_header(const std::vector<std::string>& materials, std::uint64_t vertices, std::uint64_t triangles)
{
    std::string head = "ply\nformat binary_little_endian 1.0\ncomment metres, z up; material_* are the shares of materials seen at a vertex\n";
    std::string tail = fmt::format("element vertex {}\n", vertices);
    for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) tail += fmt::format("property float {}\n", name);
    for (const std::string& name : materials) tail += fmt::format("property float material_{}\n", name);
    tail += fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n", triangles);
    const std::size_t digits = fmt::formatted_size("{}{}", vertices, triangles);
    return head + fmt::format("comment {:-<{}}\n", "", 48 - digits) + tail;
}

void write_ply(ByteSink& sink, const std::string& path, const std::vector<std::string>& materials,
               const std::function<void(const MeshSink&)>& produce, std::uint64_t& vertices, std::uint64_t& triangles)
{
    const auto write = [&](const std::string& bytes) { sink.write(bytes.data(), bytes.size()); };
    Spool spool(path);
    write(ply_header(materials, 0, 0));
    produce([&](const MeshPart& part, std::span<const float> weights) {
        std::string bytes;
        for (std::size_t i = 0; i < part.vertices.size(); ++i) {
            for (int k = 0; k < 3; ++k) append(bytes, static_cast<float>(part.vertices[i][k]));
            for (int k = 0; k < 3; ++k) append(bytes, static_cast<float>(part.normals[i][k]));
            for (std::size_t m = 0; m < materials.size(); ++m) append(bytes, weights[i * materials.size() + m]);
        }
        write(bytes);
        bytes.clear();
        for (const auto& t : part.triangles) {
            append(bytes, std::uint8_t{3});
            for (const std::uint32_t index : t) append(bytes, static_cast<std::int32_t>(index));
        }
        spool.write(bytes);
        vertices += part.vertices.size();
        triangles += part.triangles.size();
    });
    spool.copy_to(sink);
    sink.seek(0);
    write(ply_header(materials, vertices, triangles));
}

void write_obj(ByteSink& sink, const std::vector<std::string>& materials, const std::function<void(const MeshSink&)>& produce)
{
    const std::string head = "# metres, z up\n";
    sink.write(head.data(), head.size());
    std::vector<std::uint8_t> dominant;  // of every vertex so far: a triangle may name one of an earlier part
    produce([&](const MeshPart& part, std::span<const float> weights) {
        std::string text;
        const auto out = std::back_inserter(text);
        for (std::size_t i = 0; i < part.vertices.size(); ++i) {
            const Vec3d &p = part.vertices[i], &n = part.normals[i];
            fmt::format_to(out, "v {:.9g} {:.9g} {:.9g}\nvn {:.4f} {:.4f} {:.4f}\n", p.x, p.y, p.z, n.x, n.y, n.z);
            const auto own = weights.subspan(i * materials.size(), materials.size());
            dominant.push_back(static_cast<std::uint8_t>(std::max_element(own.begin(), own.end()) - own.begin()));
        }
        // Two of three corners decide; where all three differ, the first.
        const auto material_of = [&](const std::array<std::uint32_t, 3>& t) {
            return dominant[t[1]] == dominant[t[2]] ? dominant[t[1]] : dominant[t[0]];
        };
        for (std::size_t m = 0; m < materials.size(); ++m) {
            bool any = false;
            for (const auto& t : part.triangles) {
                if (material_of(t) != m) continue;
                if (!any) fmt::format_to(out, "usemtl {}\n", materials[m]);
                any = true;
                fmt::format_to(out, "f {0}//{0} {1}//{1} {2}//{2}\n", t[0] + 1, t[1] + 1, t[2] + 1);
            }
        }
        sink.write(text.data(), text.size());
    });
}

}  // namespace

void write_mesh_file(const std::string& path, const std::vector<std::string>& materials, const std::function<void(const MeshSink&)>& produce)
{
    const bool ply = path.ends_with(".ply");
    if (!ply && !path.ends_with(".obj"))
        throw Error(ErrorKind::scene, Problem{{}, "name of a mesh file", "FILE.ply or FILE.obj", '"' + path + '"', {}});
    std::uint64_t vertices = 0, triangles = 0, size = 0;
    std::exception_ptr failure;  // what went wrong in the field is no failure of the file
    const std::function<void(const MeshSink&)> guarded = [&](const MeshSink& sink) {
        try {
            produce(sink);
        } catch (const Error&) {
            failure = std::current_exception();
            throw;
        }
    };
    try {
        write_atomically(
            path,
            [&](ByteSink& sink) {
                ply ? write_ply(sink, path, materials, guarded, vertices, triangles) : write_obj(sink, materials, guarded);
                size = sink.tell();
            },
            [&](const std::string& temporary) {
                const std::uint64_t found = std::filesystem::file_size(temporary);
                const std::string head = ply ? ply_header(materials, vertices, triangles) : "# metres, z up\n";
                const std::uint64_t wanted = ply ? head.size() + vertices * 4 * (6 + materials.size()) + triangles * 13 : size;
                std::string read(head.size(), '\0');
                std::ifstream(temporary, std::ios::binary).read(read.data(), static_cast<std::streamsize>(read.size()));
                if (found != wanted || read != head) throw std::runtime_error(fmt::format("{} bytes instead of {}", found, wanted));
            });
    } catch (...) {
        if (failure) std::rethrow_exception(failure);
        throw;
    }
}

}  // namespace hoodoo
