// Meshes: read from files of three formats, moved, and refused where they are wrong.
#include "terrain/catalogue.h"
#include "terrain/io/mesh_file.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

using namespace hoodoo;

namespace
{

class MeshFile : public ::testing::Test
{
protected:
    void SetUp() override
    {
        folder_ =
            std::filesystem::temp_directory_path() / ("hoodoo_mesh_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::string write(const std::string& name, const std::string& text) const
    {
        std::ofstream(folder_ / name, std::ios::binary) << text;
        return (folder_ / name).string();
    }

    std::string error_of(const std::string& path) const
    {
        try {
            read_mesh_file(path, {}, {"scene.toml", 4, 8, {}});
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::file);
            return error.what();
        }
        return "no error";
    }

    std::filesystem::path folder_;
};

// A unit square in the plane z = 0 with corner (0, 0), as one polygon.
const std::string kSquareObj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
const std::string kSquarePly =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
    "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";
const std::string kTriangleStl = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
// Two faces of a roof with its ridge along y: the ridge's vertices are shared.
const std::string kRoofObj = "v -1 0 0\nv 0 0 1\nv 1 0 0\nv -1 2 0\nv 0 2 1\nv 1 2 0\nf 1 2 5 4\nf 2 3 6 5\n";

double area(const TriangleMesh& mesh)
{
    double sum = 0.0;
    for (const auto& t : mesh.triangles) {
        const Vec3d a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]);
        sum += 0.5 * (b - a).cross(c - a).z;
    }
    return sum;
}

TriangleMesh make(const std::string& file, std::vector<std::pair<std::string, std::vector<double>>> vectors, double scale = 1.0)
{
    const auto leaf = [](auto value) {
        Node node;
        node.value = value;
        return node;
    };
    Node::Table entries = {{"file", leaf(file)}, {"scale", leaf(scale)}};
    for (const auto& [key, numbers] : vectors) {
        Node::Array items;
        for (const double v : numbers) items.push_back(leaf(v));
        entries.emplace_back(key, leaf(items));
    }
    const CatalogueEntry* row = find_in_catalogue("mesh");
    std::vector<Problem> problems;
    const Values values = check(row->schema, leaf(entries), problems);
    for (const Problem& p : problems) ADD_FAILURE() << p.text();
    return std::get<TriangleMesh>(row->make(values, {}));
}

}  // namespace

TEST_F(MeshFile, polygons_of_each_format_become_triangles_that_face_the_same_way)
{
    for (const auto& [name, text, expected] : {std::tuple{"a.obj", kSquareObj, 1.0}, {"a.ply", kSquarePly, 1.0}, {"a.stl", kTriangleStl, 0.5}}) {
        const TriangleMesh mesh = read_mesh_file(write(name, text), {}, {});
        EXPECT_DOUBLE_EQ(area(mesh), expected) << name;  // signed: counter-clockwise from above
        ASSERT_EQ(mesh.normals.size(), mesh.vertices.size()) << name;
        for (const Vec3f& n : mesh.normals) EXPECT_LT((n - Vec3f(0, 0, 1)).length(), 1e-6f) << name;
        EXPECT_TRUE(mesh.uvs.empty()) << name;
    }
}

TEST_F(MeshFile, smooth_normals_are_the_mean_of_the_faces_and_flat_ones_are_left_to_the_faces)
{
    const std::string path = write("roof.obj", kRoofObj);
    const TriangleMesh smooth = read_mesh_file(path, {.smooth = true}, {});
    int ridge = 0;
    for (std::size_t v = 0; v < smooth.vertices.size(); ++v) {
        if (smooth.vertices[v].z != 1.0f) continue;
        ++ridge;
        EXPECT_LT((smooth.normals[v] - Vec3f(0, 0, 1)).length(), 1e-6f);  // (-1, 0, 1) + (1, 0, 1)
    }
    EXPECT_GE(ridge, 2);
    EXPECT_TRUE(read_mesh_file(path, {.smooth = false}, {}).normals.empty());
}

TEST_F(MeshFile, texture_coordinates_and_the_vertical_axis_are_the_files)
{
    const std::string path = write("uv.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.25 0.5\nvt 0.75 0.5\nvt 0.25 1\nf 1/1 2/2 3/3\n");
    const TriangleMesh mesh = read_mesh_file(path, {.smooth = true, .y_up = true}, {});
    ASSERT_EQ(mesh.uvs.size(), 3u);
    for (std::size_t v = 0; v < 3; ++v) {
        // (x, y, z) of the file stands at (x, -z, y); u = 1/4 + x/2, v = 1/2 + y/2.
        EXPECT_EQ(mesh.vertices[v].y, 0.0f);
        EXPECT_FLOAT_EQ(mesh.uvs[v].x, 0.25f + 0.5f * mesh.vertices[v].x);
        EXPECT_FLOAT_EQ(mesh.uvs[v].y, 0.5f + 0.5f * mesh.vertices[v].z);
        EXPECT_LT((mesh.normals[v] - Vec3f(0, -1, 0)).length(), 1e-6f);
    }
}

TEST_F(MeshFile, the_row_scales_turns_and_moves_about_its_origin)
{
    const std::string path = write("a.obj", kSquareObj);
    // v -> translate + origin + 2 Rz(90) (v - origin): (1, 0, 0) with origin (1, 1, 0) is (0, -1, 0) about it, turned (1, 0, 0), doubled (2, 0, 0).
    const TriangleMesh mesh = make(path, {{"rotate_deg", {0, 0, 90}}, {"translate", {4e6, 100, -7}}, {"origin", {1, 1, 0}}}, 2.0);
    bool found = false;
    for (const Vec3f& v : mesh.vertices) found = found || (mesh.origin + Vec3d(v) - Vec3d(4e6 + 3, 101, -7)).length() < 1e-6;
    EXPECT_TRUE(found);
    EXPECT_DOUBLE_EQ(mesh.origin.x, 4e6 + 1);
    EXPECT_NEAR(area(mesh), 4.0, 1e-6);
}

TEST_F(MeshFile, turns_go_about_x_then_y_then_z)
{
    const std::string path = write("a.obj", "v 0 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n");
    // (0, 1, 0): Rx(90) -> (0, 0, 1), Ry(90) -> (1, 0, 0), Rz(90) -> (0, 1, 0). (0, 0, 1): -> (0, -1, 0) -> (0, -1, 0) -> (1, 0, 0).
    const TriangleMesh mesh = make(path, {{"rotate_deg", {90, 90, 90}}});
    for (const Vec3d& expected : {Vec3d(0, 0, 0), Vec3d(0, 1, 0), Vec3d(1, 0, 0)}) {
        bool found = false;
        for (const Vec3f& v : mesh.vertices) found = found || (Vec3d(v) - expected).length() < 1e-6;
        EXPECT_TRUE(found) << expected;
    }
}

TEST_F(MeshFile, what_is_wrong_is_said_with_the_position_in_the_scene)
{
    EXPECT_NE(error_of((folder_ / "absent.obj").string()).find("scene.toml:4:8: mesh \""), std::string::npos);
    EXPECT_NE(error_of(write("a.txt", "x")).find("expected .ply, .obj or .stl"), std::string::npos);
    EXPECT_NE(error_of(write("empty.obj", "")).find("cannot be read"), std::string::npos);
    EXPECT_NE(error_of(write("points.obj", "v 0 0 0\nv 1 0 0\n")), "no error");
    EXPECT_NE(error_of(write("nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")), "no error");
    EXPECT_NE(error_of(write("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")), "no error");
    EXPECT_NE(error_of(write("index.ply", kSquarePly.substr(0, kSquarePly.size() - 2) + "9\n")), "no error");
    EXPECT_NE(error_of(write("cut.ply", kSquarePly.substr(0, kSquarePly.size() - 20))), "no error");
}

TEST_F(MeshFile, files_that_an_obj_names_are_not_opened)
{
    // A FIFO would hang whoever opens it; there is a watchdog on the test, and the mesh is read all the same.
    const std::string fifo = (folder_ / "trap.mtl").string();
    ASSERT_EQ(std::system(("mkfifo " + fifo).c_str()), 0);
    EXPECT_DOUBLE_EQ(area(read_mesh_file(write("a.obj", "mtllib trap.mtl\n" + kSquareObj), {}, {})), 1.0);
}
