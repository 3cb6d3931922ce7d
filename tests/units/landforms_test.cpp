// Landforms: the golden values of the operators, primitives by their formulas, bounds that shrink, nodes never asked, and what a scene gets wrong.

#include "renderer/scene/toml_text.h"
#include "terrain/catalogue.h"
#include "terrain/fields/elevation.h"
#include "terrain/fields/landform.h"
#include "terrain/fields/radial.h"
#include "terrain/fields/support_tree.h"
#include "tests/support/numbers.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>

namespace hoodoo
{
namespace
{

using testing::Numbers;

nlohmann::json golden()
{
    return nlohmann::json::parse(std::ifstream(HOODOO_SOURCE_DIR "/tests/golden/b_galin.json"));
}

/// A node of one height and one weight everywhere; says that it covers the plane only if it has all of it.
class Constant final : public Landform
{
public:
    Constant(double height, double weight, bool covers) : height_(height), weight_(weight), covers_(covers) {}
    Elevated<Jet2> at(const Vec2d&, double datum) const override { return {{(covers_ ? 1.0 : weight_) * (height_ - datum)}, {weight_}, {}}; }
    Elevated<AreaJet> over(const Area& area, double datum) const override
    {
        return {AreaJet::constant((covers_ ? 1.0 : weight_) * (height_ - datum), area.radius),
                AreaJet::constant(weight_, area.radius),
                {height_ - datum, height_ - datum}};
    }
    Box2d support() const override { return {Vec2d(-kInfinity), Vec2d(kInfinity)}; }
    double least_weight() const override { return covers_ ? weight_ : 0.0; }
    double most_weight() const override { return std::max(1.0, weight_); }

private:
    double height_, weight_;
    bool covers_;
};

LandformPtr constant(const nlohmann::json& pair, bool covers)
{
    return std::make_shared<Constant>(pair[0].get<double>(), pair[1].get<double>(), covers);
}

/// (height, weight) of a node at a point, whatever it hands out.
std::pair<double, double> elevation_of(const Landform& node, const Vec2d& p = Vec2d(0.0), double datum = 0.0)
{
    const Elevated<Jet2> e = node.at(p, datum);
    const double w = e.weight.value;
    return {datum + (node.covers() ? e.height.value : w > 0.0 ? e.height.value / w : -datum), w};
}

TEST(Landforms, operators_give_the_golden_heights_and_weights)
{
    for (const auto& o : golden()["operators"]) {
        const bool covers = o["A"][1].get<double>() > 0.0;
        const LandformPtr a = constant(o["A"], covers), local = constant(o["A"], false), b = constant(o["B"], false);
        const auto is = [&](const Landform& node, const char* name, double datum) {
            const auto [h, w] = elevation_of(node, Vec2d(0.0), datum);
            EXPECT_NEAR(h, o[name][0].get<double>(), 1e-12) << name << o.dump();
            EXPECT_NEAR(w, o[name][1].get<double>(), 1e-12) << name << o.dump();
        };
        for (const double datum : {0.0, 37.5}) {
            is(*landform_blend({local, b}, BlendWeight::sum), "blend", datum);
            is(*landform_blend({a, b}, BlendWeight::sum), "blend", datum);
            if (!covers) continue;
            is(*landform_apply(LandformOperator::replace, {a, b}), "replace", datum);
            is(*landform_apply(LandformOperator::inset, {a, b}), "replace_2015", datum);
            is(*landform_apply(LandformOperator::add, {a, b}), "add", datum);
            // The same from m = w h of the first.
            is(*landform_apply(LandformOperator::inset, {local, b}), "replace_2015", datum);
            is(*landform_apply(LandformOperator::add, {local, b}), "add", datum);
        }
        // Where the first has no weight its height counts as 0: the formulas themselves.
        const double wb = o["B"][1].get<double>();
        const Elevated<Jet2> first{{o["A"][0].get<double>()}, {o["A"][1].get<double>()}, {}}, second{{wb * o["B"][0].get<double>()}, {wb}, {}};
        EXPECT_NEAR(applied(LandformOperator::replace, first, second, true).height.value, o["replace"][0].get<double>(), 1e-12);
        EXPECT_NEAR(applied(LandformOperator::replace, first, second, true).weight.value, o["replace"][1].get<double>(), 1e-12);
        EXPECT_NEAR(applied(LandformOperator::inset, first, second, true).height.value, o["replace_2015"][0].get<double>(), 1e-12);
        EXPECT_NEAR(applied(LandformOperator::add, first, second, true).height.value, o["add"][0].get<double>(), 1e-12);
    }
}

TEST(Landforms, maximum_and_minimum_are_those_where_the_weight_is_1_and_fade_with_it)
{
    const auto height = [](LandformOperator what, double h, double w) {
        return elevation_of(*landform_apply(what, {landform_flat(10.0), std::make_shared<Constant>(h, w, false)})).first;
    };
    EXPECT_DOUBLE_EQ(height(LandformOperator::raise, 14.0, 1.0), 14.0);
    EXPECT_DOUBLE_EQ(height(LandformOperator::raise, 6.0, 1.0), 10.0);
    EXPECT_DOUBLE_EQ(height(LandformOperator::lower, 6.0, 1.0), 6.0);
    EXPECT_DOUBLE_EQ(height(LandformOperator::lower, 14.0, 1.0), 10.0);
    EXPECT_DOUBLE_EQ(height(LandformOperator::raise, 14.0, 0.25), 11.0);  // 10 + 0.25 (14 - 10)
    // Weights above 1 count as 1.
    EXPECT_DOUBLE_EQ(height(LandformOperator::raise, 14.0, 2.5), 14.0);
    EXPECT_DOUBLE_EQ(height(LandformOperator::inset, 14.0, 2.5), 14.0);
    EXPECT_DOUBLE_EQ(height(LandformOperator::add, 14.0, 2.5), 24.0);
}

TEST(Landforms, united_weights_stay_within_1_and_mean_the_same_height)
{
    const auto a = std::make_shared<Constant>(10.0, 0.5, false), b = std::make_shared<Constant>(40.0, 0.8, false);
    const auto [h, w] = elevation_of(*landform_blend({a, b}, BlendWeight::united));
    EXPECT_NEAR(h, (0.5 * 10.0 + 0.8 * 40.0) / 1.3, 1e-12);
    EXPECT_NEAR(w, 1.0 - 0.5 * 0.2, 1e-12);
}

TEST(Landforms, falloffs_are_as_steep_as_the_golden_maximum_and_their_bounds_say_so)
{
    const auto steepest = golden()["falloff_max_slope_times_R"];
    for (const int power : {2, 3}) {
        const Falloff falloff{7.0, 0.0, power};
        const double expected = steepest[power == 2 ? "(1-u2)^2" : "(1-u2)^3"].get<double>() / 7.0;
        double most = 0.0, bound = 0.0;
        for (int k = 0; k < 7000; ++k) {
            most = std::max(most, -falloff_at(falloff, 0.001 * k).second);
            bound = std::max(bound, falloff_over(falloff, {0.001 * k, 0.001 * (k + 1)}).curve.slope.magnitude());
        }
        EXPECT_NEAR(most, expected, 1e-6 * expected);
        EXPECT_GE(bound, most);
        EXPECT_LE(bound, expected * 1.001);
        EXPECT_EQ(falloff_at(falloff, 0.0).first, 1.0);
        EXPECT_EQ(falloff_at(falloff, 7.0).first, 0.0);
    }
    // With a core: t = (d - 2) / 5.
    const double t = 0.4, u = 1.0 - t * t;
    EXPECT_NEAR(falloff_at({7.0, 2.0, 3}, 4.0).first, u * u * u, 1e-15);
    EXPECT_EQ(falloff_at({7.0, 2.0, 3}, 1.9).first, 1.0);
}

TEST(Landforms, sections_pass_through_their_knots_and_never_beyond_them)
{
    const SectionCurve curve({{{0.0, 5.0}, {2.0, 4.0}, {3.0, 1.0}, {6.0, 1.0}, {8.0, 2.0}}, false});
    EXPECT_DOUBLE_EQ(curve.at(0.0).first, 5.0);
    EXPECT_DOUBLE_EQ(curve.at(2.0).first, 4.0);
    EXPECT_DOUBLE_EQ(curve.at(3.0).first, 1.0);
    EXPECT_DOUBLE_EQ(curve.at(4.7).first, 1.0);  // level between level knots
    EXPECT_DOUBLE_EQ(curve.at(9.0).first, 2.0);
    EXPECT_EQ(curve.at(0.0).second, 0.0);
    for (double d = 0.0; d < 3.0; d += 0.01) EXPECT_LE(curve.at(d).second, 0.0) << d;
    // A straight flank, sharp: h = 3 - d / 2 up to the last knot, where it becomes level: f(x) = 3 - x / 2 + c (x/2)^2 ... is steepest at the top.
    EXPECT_DOUBLE_EQ(SectionCurve({{{0.0, 3.0}, {2.0, 2.0}}, true}).at(0.0).second, -0.5);
    EXPECT_EQ(SectionCurve({{{0.0, 3.0}, {2.0, 2.0}}, true}).over({0.0, 0.1}).slope_by_distance, kInfinity);
}

TEST(Landforms, a_point_is_its_profile_times_its_weight)
{
    const auto point = landform_path(
        {.points = {Vec3d(3, 4, 10)}, .falloff = {5.0, 0.0, 3}, .section = {{{0.0, 2.0}, {5.0, 0.0}}, false}, .joint = 1.0, .rough = {}});
    // At (6, 8) d = 5: no weight. At (3, 6.5) d = 2.5: w = (3/4)^3; the cubic from 2 to 0, level at both ends, is at its middle.
    EXPECT_EQ(point->at({6.0, 8.0}, 0.0).weight.value, 0.0);
    const auto [h, w] = elevation_of(*point, {3.0, 6.5});
    EXPECT_NEAR(w, 27.0 / 64.0, 1e-15);
    EXPECT_NEAR(h, 11.0, 1e-12);
    // On a plain at 0 by replace: h = (1 - w) 0 + w h.
    EXPECT_NEAR(LandformHeight(landform_apply(LandformOperator::replace, {landform_flat(0.0), point})).height({3.0, 6.5}), 11.0 * 27.0 / 64.0, 1e-12);
}

TEST(Landforms, a_curve_rises_evenly_and_has_no_step_where_the_nearest_place_jumps)
{
    // A sharp bend: on its inner side the nearest place jumps from one arm to the other.
    const auto curve = landform_path(
        {.points = {Vec3d(-10, 0, 0), Vec3d(0, 0, 5), Vec3d(-10, 4, 10)}, .falloff = {6.0, 3.0, 3}, .section = {}, .joint = 1.5, .rough = {}});
    // Far from the corner on the first arm: 5 + x / 2.
    EXPECT_NEAR(elevation_of(*curve, {-9.0, -1.0}).first, 0.5, 1e-12);
    double last = elevation_of(*curve, {-4.0, -1.0}).first;
    for (double y = -1.0; y < 4.0; y += 1e-4) {
        const double h = elevation_of(*curve, {-4.0, y}).first;
        ASSERT_LT(std::abs(h - last), 2e-3) << y;
        last = h;
    }
    EXPECT_GT(last, 6.0);  // the second arm is higher there
}

/// Counts how often it is asked.
class Counting final : public Landform
{
public:
    explicit Counting(LandformPtr node) : node_(std::move(node)) {}
    Elevated<Jet2> at(const Vec2d& p, double datum) const override
    {
        ++asked;
        return node_->at(p, datum);
    }
    Elevated<AreaJet> over(const Area& area, double datum) const override
    {
        ++asked;
        return node_->over(area, datum);
    }
    Box2d support() const override { return node_->support(); }
    mutable int asked = 0;

private:
    LandformPtr node_;
};

TEST(Landforms, a_far_node_is_never_asked)
{
    std::vector<LandformPtr> hills{landform_flat(0.0)};
    std::vector<std::shared_ptr<Counting>> counts;
    for (int i = 0; i < 40; ++i) {
        for (int j = 0; j < 40; ++j) {
            counts.push_back(std::make_shared<Counting>(
                landform_path({.points = {Vec3d(10 * i, 10 * j, 5)}, .falloff = {6.0, 0.0, 3}, .section = {}, .joint = 1.0, .rough = {}})));
            hills.push_back(counts.back());
        }
    }
    const LandformHeight land(landform_apply(LandformOperator::replace, hills));
    const auto asked = [&] {
        std::pair<int, int> sum{0, 0};  // near (105, 105) and far
        for (int i = 0; i < 40; ++i)
            for (int j = 0; j < 40; ++j)
                (std::abs(10 * i - 105) <= 7 && std::abs(10 * j - 105) <= 7 ? sum.first : sum.second) +=
                    std::exchange(counts[static_cast<std::size_t>(40 * i + j)]->asked, 0);
        return sum;
    };
    land.height({105.0, 105.0});
    EXPECT_EQ(asked(), std::pair(4, 0));
    land.bounds({Vec2d(104.5), Vec2d(105.5)});
    EXPECT_EQ(asked(), std::pair(8, 0));  // the height in the middle, then the bounds
}

TEST(Landforms, the_tree_of_supports_finds_what_a_list_finds)
{
    Numbers random(3, 1);
    std::vector<Box2d> boxes{{Vec2d(-kInfinity), Vec2d(kInfinity)}};
    for (int n = 0; n < 500; ++n) {
        const Vec2d corner(100.0 * random(), 100.0 * random());
        boxes.push_back({corner, corner + Vec2d(random(), random()) * (n % 7 == 0 ? 40.0 : 3.0)});
    }
    const SupportTree tree(boxes);
    std::vector<std::uint32_t> found, expected;
    for (int n = 0; n < 300; ++n) {
        const Vec2d corner(100.0 * random(), 100.0 * random());
        const Box2d area(corner, corner + Vec2d(random(), random()) * 5.0);
        tree.find(area, found);
        expected.clear();
        for (std::uint32_t k = 0; k < boxes.size(); ++k)
            if (boxes[k].intersects(area)) expected.push_back(k);
        ASSERT_EQ(found, expected);
    }
}

TEST(Landforms, bounds_of_small_areas_shrink_to_the_function)
{
    const auto hill = landform_path({.points = {Vec3d(0, 0, 8)}, .falloff = {10.0, 0.0, 3}, .section = {}, .joint = 1.0, .rough = {}});
    const LandformHeight land(landform_apply(LandformOperator::replace, {landform_flat(1.0), hill}));
    const Vec2d p(3.0, 2.0);
    for (const double size : {1.0, 0.1, 0.01, 0.001}) {
        const HeightBounds bounds = land.bounds({p - Vec2d(size), p + Vec2d(size)});
        // |grad| r to both sides, up to the curvature's share.
        const double width = 2.0 * land.gradient(p).length() * size * std::sqrt(2.0);
        EXPECT_LT(bounds.value.hi - bounds.value.lo, width * (1.0 + 2.0 * size) + 1e-9) << size;
        EXPECT_LT(bounds.slope, land.gradient(p).length() + 2.0 * size);
        EXPECT_LT(bounds.curvature, 2.0);
    }
}

TEST(Landforms, a_moved_node_is_the_node_elsewhere_and_a_warped_one_that_at_the_moved_point)
{
    const auto hill = landform_path({.points = {Vec3d(2, 0, 3), Vec3d(4, 1, 5)}, .falloff = {3.0, 0.5, 2}, .section = {}, .joint = 1.0, .rough = {}});
    const auto moved = landform_move(hill, 2.0, M_PI / 2.0, Vec3d(10, 20, 30));
    // (x, y, z) -> 2 (-y, x, z) + (10, 20, 30).
    for (const Vec2d& q : {Vec2d(2.0, 0.0), Vec2d(3.0, 1.5), Vec2d(5.5, 0.7)}) {
        const auto [h, w] = elevation_of(*hill, q);
        const auto [mh, mw] = elevation_of(*moved, Vec2d(-2.0 * q.y + 10.0, 2.0 * q.x + 20.0));
        EXPECT_NEAR(mw, w, 1e-12);
        EXPECT_NEAR(mh, 2.0 * h + 30.0, 1e-9);
    }
    ElevationShape bend;
    bend.relief = 0.4;
    bend.wavelength = 3.0;
    const auto x = std::make_shared<const ElevationHeight>(bend);
    bend.seed = 9;
    const auto y = std::make_shared<const ElevationHeight>(bend);
    const Vec2d p(3.0, 0.8);
    EXPECT_EQ(elevation_of(*landform_warp(hill, x, y), p), elevation_of(*hill, p + Vec2d(x->height(p), y->height(p))));
}

// -- In a scene --------------------------------------------------------------------------------------------------------

Shape make(const std::string& text)
{
    SceneBudget budget;
    std::vector<Problem> problems;
    const Node table = parse_toml(text, "<text>", budget, problems);
    const CatalogueEntry* row = find_in_catalogue("landforms");
    const Values values = check(row->schema, table, problems);
    if (!problems.empty()) throw Error(ErrorKind::scene, problems);
    return row->make(values, BuildContext{});
}

std::string refusal(const std::string& text)
{
    try {
        make(text);
    } catch (const Error& error) {
        return error.problems()[0].text().substr(0, error.problems()[0].text().find('\n'));
    }
    return "accepted";
}

const std::string kArea = "extent = 20.0\n";

std::string node(const std::string& name, const std::string& kind, const std::string& rest = "")
{
    return fmt::format("[[node]]\nname = \"{}\"\nkind = \"{}\"\n{}\n", name, kind, rest);
}

TEST(Landforms, a_tree_in_a_scene_is_the_tree)
{
    // The root is named: the last node is the hill.
    const Shape shape = make(kArea + "root = \"top\"\n" + node("top", "replace", "of = [\"sea\", \"hill\"]") + node("sea", "flat", "height = 2.0") +
                             node("hill", "point", "at = [1, 1, 8]\nradius = 4.0"));
    const Surface& surface = *std::get<std::unique_ptr<Surface>>(shape);
    ASSERT_TRUE(surface.height());
    // At distance 2 of 4: w = (3/4)^3.
    EXPECT_NEAR(surface.height()->height({3.0, 1.0}), 2.0 + 6.0 * 27.0 / 64.0, 1e-12);
    EXPECT_EQ(surface.height()->height({5.0, 1.0}), 2.0);
    EXPECT_GT(surface.info().trace_bytes, 0u);
}

TEST(Landforms, what_cannot_be_is_refused_in_words)
{
    EXPECT_EQ(refusal(kArea + node("hill", "point", "at = [0, 0, 1]\nradius = 2.0")),
              "<text>:2:1: the landforms do not cover the plane, expected a root that stands on flat, noise or terrain nodes without an end");
    EXPECT_EQ(refusal(kArea + node("hill", "point", "at = [0, 0, 1]\nradius = 2.0\ncore = 2.0")),
              "<text>:7:8: where the weight begins to fall, expected less than the radius, got 2 m of 2 m");
    EXPECT_EQ(refusal(kArea + node("hill", "point", "at = [0, 0, 1]\nradius = 2.0\nprofile = [0, 1, 2]")),
              "<text>:7:11: a profile, expected a distance and a height of each knot in turn, got 3 numbers");
    EXPECT_EQ(refusal(kArea + node("hill", "point", "at = [0, 0, 1]\nradius = 2.0\nprofile = [0, 1, 2, 3, 2, 4]")),
              "<text>:7:11: distances of a profile, expected 0 or more, each larger than the last, got 2 after 2");
    EXPECT_EQ(refusal(kArea + node("hill", "point", "at = [0, 0, 1]\nradius = 2.0\nprofile = [-1, 1, 2, 3]")),
              "<text>:7:11: distances of a profile, expected 0 or more, each larger than the last, got -1");
    EXPECT_EQ(refusal(kArea + node("hill", "point", "at = [0, 0, 1]\nradius = 2.0\nrough = 1.0")),
              "<text>:7:9: a rough landform, expected both rough and rough_wavelength, got rough");
    EXPECT_EQ(refusal(kArea + node("hill", "segment", "points = [[0, 0, 1], [0, 0, 4]]\nradius = 2.0")),
              "<text>:5:10: neighbouring points of a path, expected places apart on the map, got two at (0, 0)");
    EXPECT_EQ(refusal(kArea + node("fuzz", "noise", "relief = 1.0\nwavelength = 2.0\nat = [0, 0]")),
              "<text>:7:6: a circle of noise, expected both at and radius, or neither, got at");
    EXPECT_EQ(refusal(kArea + node("hill", "point", "at = [0, 0, 1]\nradius = 2.0") + node("sea", "flat") +
                      node("all", "replace", "of = [\"hill\", \"sea\"]")),
              "<text>:14:6: what is replaced must cover the plane, expected a node that stands on flat, noise or terrain first; or kind = \"inset\", "
              "got \"hill\"");
    EXPECT_EQ(refusal(kArea + node("a", "flat") + node("b", "flat") + node("c", "blend", "of = [\"a\", \"b\"]") + node("d", "flat") +
                      node("e", "blend", "of = [\"c\", \"d\"]\nweight = \"united\"")),
              "<text>:22:10: united weights are those of nodes whose own are at most 1, expected weight = \"sum\", or other nodes, got \"c\"");
    EXPECT_EQ(refusal(kArea + node("sea", "flat") + node("sea", "flat")),
              "<text>:7:8: two nodes have one name, expected a name of its own, got \"sea\"");
    EXPECT_EQ(refusal(kArea + node("sea", "flat") + node("land", "flat")),
              "<text>:3:8: the node \"sea\" is used by nothing, expected a node that \"land\" is made of");
    EXPECT_EQ(refusal(kArea + node("all", "add", "of = [\"sae\", \"sea\"]") + node("sea", "flat") + "\n"),
              "<text>:3:8: the node \"all\" is used by nothing, expected a node that \"sea\" is made of");
    EXPECT_EQ(refusal(kArea + node("a", "blend", "of = [\"b\"]") + node("b", "blend", "of = [\"a\"]")),
              "<text>:7:8: the node \"b\" is made of itself, expected nodes without a circle");
    EXPECT_EQ(refusal(kArea + node("ground", "terrain", "terrain = \"none\"")),
              "<text>:5:11: there is no other terrain to stand on, expected the name of a terrain, got \"none\"");
}

}  // namespace
}  // namespace hoodoo
