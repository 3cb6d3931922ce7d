// Fields as triangles: closed, without seams between tiles, on the surface, turned outwards; and the files they are written to.
#include "terrain/io/polygonise.h"

#include "tests/stacks.h"
#include "terrain/error.h"
#include "terrain/io/mesh_file.h"
#include "terrain/io/mesh_writer.h"
#include "terrain/stack/convolution.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <set>
#include <sstream>

namespace hoodoo
{
namespace
{

class Ball final : public Field
{
public:
    Ball(Vec3d centre, double radius) : centre_(centre), radius_(radius) {}
    double value(const Vec3d& p) const override { return (p - centre_).length() - radius_; }
    Vec3d gradient(const Vec3d& p) const override { return (p - centre_).normalized(); }
    double slope_bound(const Segment&) const override { return 1.0; }
    Interval range(const Box3d& box) const override
    {
        const double half = 0.5 * (box.max - box.min).length(), middle = value(0.5 * (box.min + box.max));
        return {middle - half, middle + half};
    }
    Box3d bounds() const override { return {centre_ - Vec3d(radius_), centre_ + Vec3d(radius_)}; }

private:
    Vec3d centre_;
    double radius_;
};

/// z < slope . (x, y): matter without end.
class Slope final : public Field
{
public:
    explicit Slope(Vec2d slope) : slope_(slope) {}
    double value(const Vec3d& p) const override { return p.z - slope_.x * p.x - slope_.y * p.y; }
    Vec3d gradient(const Vec3d&) const override { return {-slope_.x, -slope_.y, 1.0}; }
    double slope_bound(const Segment&) const override { return gradient({}).length(); }
    Interval range(const Box3d& box) const override
    {
        const Vec3d half = 0.5 * (box.max - box.min);
        const double middle = value(0.5 * (box.min + box.max)), swing = half.z + std::abs(slope_.x) * half.x + std::abs(slope_.y) * half.y;
        return {middle - swing, middle + swing};
    }
    Box3d bounds() const override { return {Vec3d(-kInfinity), Vec3d(kInfinity)}; }

private:
    Vec2d slope_;
};

struct Whole : MeshPart {
    PolygoniseReport report;
};

Whole all_of(const Field& field, const PolygoniseOptions& options)
{
    Whole whole;
    whole.report = polygonise(field, options, [&](const MeshPart& part) {
        whole.vertices.insert(whole.vertices.end(), part.vertices.begin(), part.vertices.end());
        whole.normals.insert(whole.normals.end(), part.normals.begin(), part.normals.end());
        whole.triangles.insert(whole.triangles.end(), part.triangles.begin(), part.triangles.end());
    });
    return whole;
}

using Edges = std::multiset<std::pair<std::uint32_t, std::uint32_t>>;

Edges edges_of(const MeshPart& mesh)
{
    Edges edges;
    for (const auto& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) edges.emplace(t[k], t[(k + 1) % 3]);
    return edges;
}

/// Edges that no triangle on the other side runs back along: none if the mesh is closed.
std::size_t open_edges(const MeshPart& mesh)
{
    const Edges edges = edges_of(mesh);
    return static_cast<std::size_t>(std::count_if(edges.begin(), edges.end(), [&](const auto& e) {
        return edges.count(e) != edges.count({e.second, e.first});
    }));
}

double volume_of(const MeshPart& mesh)
{
    double volume = 0.0;
    for (const auto& t : mesh.triangles) volume += mesh.vertices[t[0]].dot(mesh.vertices[t[1]].cross(mesh.vertices[t[2]])) / 6.0;
    return volume;
}

TEST(Polygonise, a_ball_is_closed_has_its_volume_and_its_error_is_that_of_chords)
{
    const Vec3d centre(100.3, -7.2, 31.7);
    const double radius = 5.0, h = 0.25;
    const Ball ball(centre, radius);
    const Whole mesh = all_of(ball, {h, Box3d(centre - Vec3d(5.5), centre + Vec3d(5.5)), 16});
    EXPECT_EQ(open_edges(mesh), 0u);
    // Euler: V - E + F = 2, and each triangle has one and a half edges of its own.
    EXPECT_EQ(2 * mesh.vertices.size(), mesh.triangles.size() + 4);
    EXPECT_EQ(mesh.report.vertices, mesh.vertices.size());
    EXPECT_EQ(mesh.report.triangles, mesh.triangles.size());
    EXPECT_EQ(mesh.report.unrefined, 0u);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        EXPECT_NEAR((mesh.vertices[i] - centre).length(), radius, 1e-9);
        EXPECT_NEAR(mesh.normals[i].dot((mesh.vertices[i] - centre) / radius), 1.0, 1e-10);
    }
    // Between vertices on the sphere a chord of length c lies c^2 / (8 r) deep; c is at most the diagonal of two cells' points, 2 sqrt(3) h. The
    // inner volume lacks the mean depth times the area.
    const double deepest = 12.0 * h * h / (8.0 * radius);
    EXPECT_LT(mesh.report.maximum_error, deepest);
    EXPECT_GT(mesh.report.maximum_error, h * h / (8.0 * radius));
    EXPECT_LT(mesh.report.mean_error, mesh.report.maximum_error);
    const double full = 4.0 / 3.0 * std::numbers::pi * radius * radius * radius, area = 4.0 * std::numbers::pi * radius * radius;
    EXPECT_LT(volume_of(mesh), full);
    EXPECT_GT(volume_of(mesh), full - deepest * area);
    // The mean over each triangle of a depth that vanishes in its corners is a little less than what centroid and midpoints say.
    EXPECT_NEAR(full - volume_of(mesh), mesh.report.mean_error * mesh.report.area, 0.3 * mesh.report.mean_error * mesh.report.area);
    EXPECT_NEAR(mesh.report.area, area, 0.01 * area);
}

TEST(Polygonise, a_slope_is_cut_straight_at_the_sides_of_its_region)
{
    const Slope slope({0.3, -0.2});
    const Box3d region(Vec3d(-3.1, 2.0, -4.0), Vec3d(7.3, 9.7, 4.0));
    const Whole mesh = all_of(slope, {0.5, region, 8});
    Box3d box;
    for (const Vec3d& p : mesh.vertices) {
        EXPECT_NEAR(slope.value(p), 0.0, 1e-9);
        box.extendBy(p);
    }
    // The outermost points lie on the side, or within half a cell of it where the last cell has its point inside.
    for (int k = 0; k < 2; ++k) {
        EXPECT_GE(box.min[k], region.min[k]);
        EXPECT_LT(box.min[k], region.min[k] + 0.26);
        EXPECT_LE(box.max[k], region.max[k]);
        EXPECT_GT(box.max[k], region.max[k] - 0.26);
    }
    EXPECT_NEAR(mesh.report.maximum_error, 0.0, 1e-9);
    // All of the rectangle, but for half a cell on each side at most.
    const double full = 10.4 * 7.7 * std::sqrt(1.0 + 0.09 + 0.04);
    EXPECT_LT(mesh.report.area, full);
    EXPECT_GT(mesh.report.area, full * (9.9 / 10.4) * (7.2 / 7.7));
}

/// Triangles as corners, so that meshes with another numbering compare equal.
std::multiset<std::array<double, 9>> corners_of(const MeshPart& mesh)
{
    std::multiset<std::array<double, 9>> all;
    for (const auto& t : mesh.triangles) {
        std::array<std::array<double, 3>, 3> p;
        for (std::size_t k = 0; k < 3; ++k) p[k] = {mesh.vertices[t[k]].x, mesh.vertices[t[k]].y, mesh.vertices[t[k]].z};
        std::rotate(p.begin(), std::min_element(p.begin(), p.end()), p.end());
        all.insert({p[0][0], p[0][1], p[0][2], p[1][0], p[1][1], p[1][2], p[2][0], p[2][1], p[2][2]});
    }
    return all;
}

TEST(Polygonise, tiles_leave_no_seam_on_terrains_with_overhangs_and_never_change_the_surface)
{
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        const auto stack = testing::random_stack(seed, {26, 21}, 1.0, 0.1, 120, Vec3d(1000.5, -20.25, 3.0));
        const ConvolutionField field(Ground(stack, kGround, Border::cut, 20), 1.5);
        const PolygoniseOptions small{0.75, Box3d(field.bounds().min - Vec3d(1.0), field.bounds().max + Vec3d(1.0)), 8};
        PolygoniseOptions large = small;
        large.tile = 256;
        const Whole in_tiles = all_of(field, small), at_once = all_of(field, large);
        EXPECT_EQ(open_edges(in_tiles), 0u) << seed;
        EXPECT_EQ(open_edges(at_once), 0u) << seed;
        EXPECT_EQ(corners_of(in_tiles), corners_of(at_once)) << seed;
        EXPECT_EQ(in_tiles.report.maximum_error, at_once.report.maximum_error);
        EXPECT_NEAR(in_tiles.report.mean_error, at_once.report.mean_error, 1e-12);
        EXPECT_GT(volume_of(in_tiles), 26 * 21 * 2.0);
    }
}

TEST(Polygonise, a_mesh_with_one_triangle_turned_or_missing_is_seen_to_be_open)
{
    Whole mesh = all_of(Ball(Vec3d(0.0), 2.0), {0.5, Box3d(Vec3d(-2.5), Vec3d(2.5)), 8});
    std::swap(mesh.triangles[5][0], mesh.triangles[5][1]);
    EXPECT_NE(open_edges(mesh), 0u);
    std::swap(mesh.triangles[5][0], mesh.triangles[5][1]);
    EXPECT_EQ(open_edges(mesh), 0u);
    mesh.triangles.pop_back();
    EXPECT_EQ(open_edges(mesh), 3u);
}

/// A ball of radius 2 that tells nothing beyond 0.02 of its surface: there its gradient is 0.
class ClampedBall final : public Field
{
public:
    double value(const Vec3d& p) const override { return std::clamp(p.length() - 2.0, -0.02, 0.02); }
    Vec3d gradient(const Vec3d& p) const override { return std::abs(p.length() - 2.0) < 0.02 ? p.normalized() : Vec3d(0.0); }
    double slope_bound(const Segment&) const override { return 1.0; }
    Interval range(const Box3d&) const override { return {-0.02, 0.02}; }
    Box3d bounds() const override { return {Vec3d(-2.0), Vec3d(2.0)}; }
};

TEST(Polygonise, the_greatest_error_is_no_less_than_the_true_one_and_has_no_cap)
{
    // h = 1: middles of edges of length e lie R - sqrt(R^2 - e^2 / 4) under the ball, about 0.2: where the field tells nothing. Ways along the
    // gradient would not be found there.
    const Whole mesh = all_of(ClampedBall(), {1.0, Box3d(Vec3d(-3.5), Vec3d(3.5)), 16});
    double true_error = 0.0;
    for (const auto& t : mesh.triangles) {
        const Vec3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
        for (const Vec3d& p : {(a + b + c) / 3.0, 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)})
            true_error = std::max(true_error, std::abs(p.length() - 2.0));
    }
    EXPECT_GT(true_error, 0.02);
    EXPECT_GE(mesh.report.maximum_error, true_error * (1.0 - 1e-6));
    EXPECT_LT(mesh.report.maximum_error, 1.2 * true_error);
    EXPECT_LT(mesh.report.mean_error, mesh.report.maximum_error);
    EXPECT_EQ(mesh.report.far_triangles, 0u);
}

TEST(Polygonise, has_the_same_bits_for_any_number_of_threads)
{
    const auto stack = testing::random_stack(9, {30, 30}, 1.0, 0.1, 150);
    const ConvolutionField field(Ground(stack, kGround, Border::cut, 20), 1.0);
    const PolygoniseOptions options{1.0, field.bounds(), 16};
    const auto with = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return all_of(field, options);
    };
    const Whole one = with(1), four = with(4);
    EXPECT_EQ(one.vertices, four.vertices);
    EXPECT_EQ(one.normals, four.normals);
    EXPECT_EQ(one.triangles, four.triangles);
    EXPECT_EQ(one.report.mean_error, four.report.mean_error);
}

TEST(Polygonise, a_lattice_too_fine_for_the_region_is_refused)
{
    try {
        all_of(Slope({0, 0}), {1e-9, Box3d(Vec3d(0), Vec3d(10)), 8});
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()),
                  "lattice of a mesh, expected a finite region and a spacing that divides it into less than 2^31, got 10000000000 steps of 1e-09 m");
    }
}

class MeshWriter : public ::testing::Test
{
protected:
    std::string path(const std::string& name)
    {
        const auto full = std::filesystem::temp_directory_path() / ("hoodoo_mesh_writer_" + name);
        written_.push_back(full);
        return full.string();
    }
    ~MeshWriter() override
    {
        for (const auto& p : written_) std::filesystem::remove(p);
    }
    /// Two parts; the second uses a vertex of the first.
    static void two_parts(const MeshSink& sink)
    {
        MeshPart first{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}}, {{0, 1, 2}}};
        MeshPart second{{{1, 1, 0.25}}, {{0, 1, 0}}, {{1, 3, 2}}};
        sink(first, std::array<float, 6>{1, 0, 0.25f, 0.75f, 0, 1});
        sink(second, std::array<float, 2>{0.1f, 0.9f});
    }

private:
    std::vector<std::filesystem::path> written_;
};

std::string text_of(const std::string& path)
{
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
}

TEST_F(MeshWriter, a_ply_has_its_counts_first_and_reads_back)
{
    const std::string file = path("a.ply");
    write_mesh_file(file, {"sand", "bedrock"}, two_parts);
    const std::string text = text_of(file), head = text.substr(0, text.find("end_header\n") + 11);
    EXPECT_NE(head.find("element vertex 4\nproperty float x\n"), std::string::npos);
    EXPECT_NE(head.find("property float material_sand\nproperty float material_bedrock\nelement face 2\nproperty list uchar int vertex_indices\n"),
              std::string::npos);
    EXPECT_EQ(text.size(), head.size() + 4 * 8 * 4 + 2 * 13);
    float fourth[8];
    std::memcpy(fourth, text.data() + head.size() + 3 * sizeof fourth, sizeof fourth);
    EXPECT_EQ(std::vector<float>(fourth, fourth + 8), (std::vector<float>{1, 1, 0.25f, 0, 1, 0, 0.1f, 0.9f}));
    const TriangleMesh mesh = read_mesh_file(file, {}, {});
    EXPECT_EQ(mesh.vertices, (std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0.25f}}));
    EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {1, 3, 2}}));
    EXPECT_EQ(mesh.normals[3], Vec3f(0, 1, 0));
}

TEST_F(MeshWriter, an_obj_names_the_material_that_most_corners_have)
{
    const std::string file = path("a.obj");
    write_mesh_file(file, {"sand", "bedrock"}, two_parts);
    // Corners: sand, bedrock, bedrock, bedrock.
    EXPECT_EQ(text_of(file),
              "# metres, z up\nv 0 0 0\nvn 0.0000 0.0000 1.0000\nv 1 0 0\nvn 0.0000 0.0000 1.0000\nv 0 1 0\nvn 0.0000 0.0000 1.0000\n"
              "usemtl bedrock\nf 1//1 2//2 3//3\nv 1 1 0.25\nvn 0.0000 1.0000 0.0000\nusemtl bedrock\nf 2//2 4//4 3//3\n");
    EXPECT_EQ(read_mesh_file(file, {}, {}).triangles.size(), 2u);
}

TEST_F(MeshWriter, what_fails_leaves_no_file_and_keeps_its_own_error)
{
    const std::string file = path("b.ply");
    const auto failing = [](const MeshSink& sink) {
        two_parts(sink);
        throw Error(ErrorKind::scene, "the terrain is wrong");
    };
    try {
        write_mesh_file(file, {"sand", "bedrock"}, failing);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()), "the terrain is wrong");
        EXPECT_EQ(error.kind(), ErrorKind::scene);
    }
    EXPECT_FALSE(std::filesystem::exists(file));
    EXPECT_THROW(write_mesh_file(path("c.stl"), {}, two_parts), Error);
}

}  // namespace
}  // namespace hoodoo
