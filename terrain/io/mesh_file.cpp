// Mesh files through Assimp, which knows the dialects: joined, triangulated, checked before anything trusts an index.
//
// Assimp opens what a file names (an OBJ's material library); here it may open the one file it was given and nothing else, so that a scene
// cannot read outside its roots. Smooth normals that a file lacks are the equally weighted means of the faces at a position.
// Deviation: Assimp keeps coordinates in single precision, also from files that store doubles.
// Missing: colours, several materials in one file, writing.

#include "terrain/io/mesh_file.h"

#include <assimp/DefaultIOSystem.h>
#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

namespace hoodoo
{

namespace
{

constexpr std::uintmax_t kLargestFile = 2ull << 30;
const std::vector<std::string> kEndings = {".ply", ".obj", ".stl"};

class OneFile final : public Assimp::DefaultIOSystem
{
public:
    explicit OneFile(std::string path) : path_(std::move(path)) {}
    bool Exists(const char* file) const override { return path_ == file; }
    Assimp::IOStream* Open(const char* file, const char* mode) override
    {
        return path_ == file && mode[0] == 'r' ? DefaultIOSystem::Open(file, mode) : nullptr;
    }

private:
    std::string path_;
};

[[noreturn]] void fail(const Source& where, std::string what, std::string expected = {}, std::string got = {})
{
    throw Error(ErrorKind::file, Problem{where, std::move(what), std::move(expected), std::move(got), {}});
}

void check_before_reading(const std::string& path, const Source& where)
{
    std::string ending = std::filesystem::path(path).extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (std::find(kEndings.begin(), kEndings.end(), ending) == kEndings.end())
        fail(where, "mesh \"" + path + "\" has an unknown format", ".ply, .obj or .stl", "\"" + ending + "\"");
    std::error_code failed;
    if (!std::filesystem::is_regular_file(path, failed)) fail(where, "mesh \"" + path + "\" cannot be read", "a regular file");
    const std::uintmax_t bytes = std::filesystem::file_size(path, failed);
    if (failed || bytes > kLargestFile) fail(where, "mesh \"" + path + "\" is too large", "at most 2 GB", std::to_string(bytes) + " bytes");
}

unsigned processing(bool smooth)
{
    // Validation comes first: a face that names a vertex the file lacks would send the later steps out of bounds.
    const unsigned always = aiProcess_ValidateDataStructure | aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_JoinIdenticalVertices |
                            aiProcess_PreTransformVertices | aiProcess_RemoveComponent;
    return smooth ? always | aiProcess_GenSmoothNormals : always;
}

Vec3f turned(const aiVector3D& v, bool y_up)
{
    return y_up ? Vec3f(v.x, -v.z, v.y) : Vec3f(v.x, v.y, v.z);
}

void append(const aiMesh& part, const MeshFileOptions& options, TriangleMesh& mesh)
{
    if (!(part.mPrimitiveTypes & aiPrimitiveType_TRIANGLE)) return;  // the triangulator adds a flag
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
        mesh.vertices.push_back(turned(part.mVertices[v], options.y_up));
        if (options.smooth) mesh.normals.push_back(part.HasNormals() ? turned(part.mNormals[v], options.y_up) : Vec3f(0.0f));
        const bool has_uv = part.HasTextureCoords(0);
        mesh.uvs.push_back(has_uv ? Vec2f(part.mTextureCoords[0][v].x, part.mTextureCoords[0][v].y) : Vec2f(0.0f));
    }
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
        const aiFace& face = part.mFaces[f];
        if (face.mNumIndices != 3) continue;
        mesh.triangles.push_back({first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
    }
}

Vec3f face_normal(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& t)
{
    const Vec3d a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]);
    return Vec3f((b - a).cross(c - a).normalized());
}

/// Normals from files are not unit vectors, or not vectors at all: those become the normal of one of their faces.
void repair_normals(TriangleMesh& mesh)
{
    for (const auto& t : mesh.triangles)
        for (const std::uint32_t v : t) {
            Vec3f& n = mesh.normals[v];
            const float length = n.length();
            if (!(length > 0.5f && length < 2.0f)) n = face_normal(mesh, t);
        }
    for (Vec3f& n : mesh.normals) n.normalize();
}

void check_after_reading(const TriangleMesh& mesh, const std::string& path, const Source& where)
{
    if (mesh.triangles.empty()) fail(where, "mesh \"" + path + "\" has no triangle");
    for (const Vec3f& v : mesh.vertices)
        if (!is_finite(Vec3d(v))) fail(where, "mesh \"" + path + "\" has a vertex that is not finite");
    for (const auto& t : mesh.triangles)
        for (const std::uint32_t v : t)
            if (v >= mesh.vertices.size())
                fail(where, "mesh \"" + path + "\" names a vertex it does not have", "less than " + std::to_string(mesh.vertices.size()),
                     std::to_string(v));
}

}  // namespace

TriangleMesh read_mesh_file(const std::string& path, const MeshFileOptions& options, const Source& where)
{
    check_before_reading(path, where);
    Assimp::Importer importer;
    importer.SetIOHandler(new OneFile(path));  // the importer deletes it
    importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    int removed = aiComponent_COLORS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS | aiComponent_TEXTURES |
                  aiComponent_LIGHTS | aiComponent_CAMERAS | aiComponent_MATERIALS;
    if (!options.smooth) removed |= aiComponent_NORMALS;
    importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, removed);
    const aiScene* scene = importer.ReadFile(path, processing(options.smooth));
    if (!scene) fail(where, "mesh \"" + path + "\" cannot be read", {}, importer.GetErrorString());

    TriangleMesh mesh;
    bool any_uv = false;
    for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
        append(*scene->mMeshes[m], options, mesh);
        any_uv = any_uv || scene->mMeshes[m]->HasTextureCoords(0);
    }
    if (!any_uv) mesh.uvs.clear();
    check_after_reading(mesh, path, where);
    if (options.smooth) repair_normals(mesh);
    return mesh;
}

}  // namespace hoodoo
