// The tree stands in a scene as a flat list of named nodes, each a table with a kind; operators name the nodes they are made of, before or after
// them. So a cave is one line to move or to leave out, and the tree is read from its bottom. Every node but the root is used by another: one that is
// not is most likely a forgotten name, and an error. A node may be used twice. Curves are centripetal Catmull-Rom, flattened to pieces whose turn is
// small.
#include "terrain/surfaces/implicit_nodes.h"

#include "terrain/error.h"
#include "terrain/math/hash.h"
#include "terrain/surfaces/flow_tables.h"
#include "terrain/surfaces/node_tables.h"
#include "terrain/surfaces/path_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

Parameter length(const std::string& name, const std::string& doc)
{
    return {.name = name, .type = ParameterType::length, .doc = doc, .required = true, .unit = "m", .minimum = 0, .above_minimum = true};
}

Parameter nodes(const std::string& doc, int least)
{
    return {.name = "of", .type = ParameterType::names, .doc = doc, .required = true, .min_count = least, .max_count = 4096};
}

/// `width` of the filled edge; a required one for blend.
Parameter width(bool required)
{
    Parameter p{.name = "width",
                .type = ParameterType::length,
                .doc = "How wide edges between them are filled, or rounded off; by a quarter of it where two meet.",
                .unit = "m",
                .minimum = 0};
    if (required) {
        p.required = true;
        p.above_minimum = true;
    } else {
        p.fallback = 0.0;
    }
    return p;
}

void add_shared(Schema& schema, bool primitive)
{
    schema.parameters.insert(schema.parameters.begin(),
                             {.name = "name", .type = ParameterType::text, .doc = "What other nodes call it.", .required = true});
    if (primitive)
        schema.parameters.push_back({.name = "material",
                                     .type = ParameterType::text,
                                     .doc = "Of its surface; what it is carved out of shows its own without.",
                                     .fallback = std::string()});
}

// -- Primitives --------------------------------------------------------------------------------------------------------

BlobPtr polygon(const Values& v, std::int32_t material)
{
    const std::vector<Vec3d>& corners = v.points("points");
    Vec3d normal(0.0);
    Box3d box;
    for (std::size_t n = 0; n < corners.size(); ++n) {
        normal += (corners[n] - corners[0]).cross(corners[(n + 1) % corners.size()] - corners[0]);
        box.extendBy(corners[n]);
    }
    if (!(normal.length() > 1e-12 * box.size().length2())) throw v.problem("points", "a polygon", "corners that enclose an area");
    normal.normalize();
    for (std::size_t n = 0; n < corners.size(); ++n)
        if (const double off = std::abs((corners[n] - corners[0]).dot(normal)); off > 1e-6 * box.size().length())
            throw v.problem("points", "a polygon", "corners in one plane", fmt::format("number {} lies {:.3g} m off it", n + 1, off));
    return blob_polygon(corners, v.number("radius"), material);
}

BlobPtr sweep(const Values& v, std::int32_t material)
{
    const std::vector<double>& numbers = v.vector("profile");
    if (numbers.size() % 2 != 0) throw v.problem("profile", "a profile", "x and y of each corner in turn", fmt::format("{} numbers", numbers.size()));
    std::vector<Vec2d> profile;
    for (std::size_t n = 0; n < numbers.size(); n += 2) profile.emplace_back(numbers[n], numbers[n + 1]);
    const TablePath path = path_of(v, "scale");
    for (std::size_t n = 0; n + 2 < path.points.size(); ++n)
        if ((path.points[n + 1] - path.points[n]).normalized().dot((path.points[n + 2] - path.points[n + 1]).normalized()) < -0.5)
            throw v.problem(
                "points", "the path of a sweep", "turns of at most 120 degrees",
                fmt::format("a sharper one near ({:.6g}, {:.6g}, {:.6g})", path.points[n + 1].x, path.points[n + 1].y, path.points[n + 1].z));
    return blob_sweep(path.points, path.values, std::move(profile), material);
}

// -- The tree ----------------------------------------------------------------------------------------------------------

class Builder final : private NodeTables<BlobNode>
{
public:
    Builder(const Values& row, const BuildContext& context) : NodeTables(row), context_(context) {}

    ImplicitTree build()
    {
        tree_.root = build_root();
        return std::move(tree_);
    }

private:
    BlobPtr make(const Values& v, const std::string& name) override
    {
        const std::string& kind = v.variant();
        if (kind == "union") return blob_combine(BlobOperator::unite, parts(v), v.number("width"));
        if (kind == "blend") return blob_combine(BlobOperator::unite, parts(v), v.number("width"));
        if (kind == "intersection") return blob_combine(BlobOperator::intersect, parts(v), v.number("width"));
        if (kind == "difference") return blob_combine(BlobOperator::subtract, parts(v), v.number("width"));
        if (kind == "terrain") return terrain(v);
        if (kind == "warp") {
            FlowPtr flow = make_flow(v.tables("flow"), hash_name(context_.seed, name));
            const double intensity = v.number("intensity");
            const std::string why_not = Warp::why_not(*flow, intensity);
            if (!why_not.empty()) throw v.problem("intensity", why_not, "a weaker or wider flow");
            return blob_warp(part(v), Warp(std::move(flow), intensity), intensity);
        }
        if (kind == "noise") {
            return blob_noise(part(v), {v.number("amplitude"), v.number("wavelength"), v.number("octaves"), v.number("gain"),
                                        static_cast<std::uint32_t>(hash_name(context_.seed, name) >> 32), v.vec3("origin")});
        }
        const BlobPtr primitive = skeletal(v, kind);
        tree_.primitives.extendBy(primitive->bounds());
        return primitive;
    }

    BlobPtr skeletal(const Values& v, const std::string& kind)
    {
        const std::int32_t material = material_of(v.text("material"));
        if (kind == "point") return blob_curve({v.vec3("at")}, {v.number("radius")}, material);
        if (kind == "segment") return blob_curve(v.points("points"), one_a_point(v, "radius", 2), material);
        if (kind == "curve") {
            TablePath path = path_of(v, "radius");
            return blob_curve(std::move(path.points), std::move(path.values), material);
        }
        if (kind == "disc") {
            if (!(v.vec3("normal").length() > 0.0)) throw v.problem("normal", "the normal of a disc", "a vector with a length");
            return blob_disc(v.vec3("centre"), v.vec3("normal"), v.number("extent"), v.number("radius"), material);
        }
        return kind == "polygon" ? polygon(v, material) : sweep(v, material);
    }

    BlobPtr terrain(const Values& v)
    {
        const std::string& name = v.text("terrain");
        if (!context_.base) throw v.problem("terrain", "there is no other terrain to carve", "the name of a terrain", '"' + name + '"');
        std::shared_ptr<const Surface> base = context_.base(name, v.where("terrain"));
        const Field* field = base->field();
        if (!field) throw v.problem("terrain", "this terrain cannot be carved: it has no field", "a terrain with one field", '"' + name + '"');
        Box3d box;
        for (std::uint32_t tile = 0; tile < base->tile_count(); ++tile)
            for (std::uint32_t i = 0; i < base->patch_count(tile); ++i) box.extendBy(base->patch_bounds({tile, i}));
        tree_.ground.extendBy(box);
        if (base->closed()) {
            tree_.primitives.extendBy(box);
        } else {
            tree_.open = true;
            box.min.z = -kInfinity;  // there is rock below it, as far as its field says
        }
        const auto number = static_cast<std::int32_t>(tree_.terrains.size());
        tree_.terrains.push_back(base);
        return blob_terrain(std::shared_ptr<const Field>(std::move(base), field), box, v.number("scale"), number);
    }

    std::int32_t material_of(const std::string& name)
    {
        if (name.empty()) return BlobShares::kNoSource;
        const auto found = std::find(tree_.materials.begin(), tree_.materials.end(), name);
        if (found == tree_.materials.end()) tree_.materials.push_back(name);
        return static_cast<std::int32_t>(std::find(tree_.materials.begin(), tree_.materials.end(), name) - tree_.materials.begin());
    }

    const BuildContext& context_;
    ImplicitTree tree_;
};

Parameter place(const std::string& name, const std::string& doc)
{
    return {.name = name, .type = ParameterType::vector, .doc = doc, .required = true, .unit = "m", .min_count = 3, .max_count = 3};
}

Parameter along(const std::string& name, const std::string& doc, const std::string& unit)
{
    return {.name = name,
            .type = ParameterType::vector,
            .doc = doc,
            .required = true,
            .unit = unit,
            .minimum = 0,
            .above_minimum = true,
            .min_count = 1,
            .max_count = 65536};
}

Parameter corners(const std::string& name, const std::string& doc, int least, int most)
{
    return {.name = name, .type = ParameterType::points, .doc = doc, .required = true, .min_count = least, .max_count = most};
}

std::vector<Schema> primitive_schemas()
{
    Parameter scale = along("scale", "Of the profile: one, or one a point.", "");
    scale.required = false;
    scale.fallback = std::vector<double>{1.0};
    Parameter profile{.name = "profile",
                      .type = ParameterType::vector,
                      .doc = "Corners of the cross section: x (to the right) and y (up) of each in turn.",
                      .required = true,
                      .unit = "m",
                      .min_count = 6,
                      .max_count = 4096};
    return {
        {"point", "A ball.", {place("at", "Its centre."), length("radius", "Of the ball.")}},
        {"segment",
         "A ball moved from one point to another.",
         {corners("points", "Two ends.", 2, 2), along("radius", "Of the ball: one, or one an end.", "m")}},
        {"curve",
         "A ball moved along a curve.",
         {corners("points", "The curve.", 1, 4096), along("radius", "Of the ball: one, or one a point.", "m"), smooth_parameter()}},
        {"disc",
         "All near a round disc.",
         {place("centre", "Its centre."),
          {.name = "normal",
           .type = ParameterType::vector,
           .doc = "Across it.",
           .fallback = std::vector<double>{0, 0, 1},
           .min_count = 3,
           .max_count = 3},
          length("extent", "Radius of the disc."),
          length("radius", "How near.")}},
        {"polygon", "All near a plane polygon.", {corners("points", "Its corners, in one plane, in turn.", 3, 4096), length("radius", "How near.")}},
        {"sweep",
         "A cross section moved along a path.",
         {corners("points", "The path.", 2, 4096), std::move(profile), std::move(scale), smooth_parameter()}},
    };
}

std::vector<Schema> operator_schemas()
{
    return {
        {"union", "All that is in any of them.", {nodes("The nodes it is made of.", 1), width(false)}},
        {"intersection", "What is in all of them.", {nodes("The nodes it is made of.", 1), width(false)}},
        {"difference", "The first without the others.", {nodes("What is carved, then what carves.", 2), width(false)}},
        {"blend", "All of them, run together.", {nodes("The nodes it is made of.", 1), width(true)}},
        {"warp",
         "A node carried along flows.",
         {{.name = "of", .type = ParameterType::text, .doc = "The node.", .required = true},
          {.name = "flow",
           .type = ParameterType::tables,
           .doc = "Flows; they act together.",
           .required = true,
           .min_count = 1,
           .max_count = 16,
           .discriminator = "kind",
           .items = flow_schemas()},
          {.name = "intensity", .type = ParameterType::number, .doc = "For how long the flow carries it.", .fallback = 1.0, .minimum = 0}}},
        {"noise",
         "A node with a rough surface.",
         {{.name = "of", .type = ParameterType::text, .doc = "The node.", .required = true},
          length("amplitude", "How far the surface moves at most."),
          length("wavelength", "Of the first octave."),
          {.name = "octaves", .type = ParameterType::number, .doc = "How many octaves.", .fallback = 4.0, .minimum = 1, .maximum = 12},
          {.name = "gain",
           .type = ParameterType::number,
           .doc = "Amplitude of each octave by that of the one before.",
           .fallback = 0.5,
           .minimum = 0,
           .maximum = 1},
          {.name = "origin",
           .type = ParameterType::vector,
           .doc = "A corner of the noise's lattice.",
           .fallback = std::vector<double>{0, 0, 0},
           .unit = "m",
           .min_count = 3,
           .max_count = 3}}},
        {"terrain",
         "Another terrain of the scene, to build on or to carve. It is not rendered itself.",
         {{.name = "terrain", .type = ParameterType::text, .doc = "Its name.", .required = true},
          {.name = "scale",
           .type = ParameterType::number,
           .doc = "Metres a unit of its field, for blends: about sigma for a convolution.",
           .fallback = 1.0,
           .minimum = 0,
           .above_minimum = true}}},
    };
}

}  // namespace

std::vector<Schema> implicit_node_schemas()
{
    std::vector<Schema> list = primitive_schemas();
    for (Schema& schema : list) add_shared(schema, true);
    for (Schema schema : operator_schemas()) {
        add_shared(schema, false);
        list.push_back(std::move(schema));
    }
    return list;
}

ImplicitTree make_implicit_tree(const Values& row, const BuildContext& context)
{
    return Builder(row, context).build();
}

}  // namespace hoodoo
