// A tunnel is what a cross section leaves behind; a ravine is a tunnel laid onto the ground.
//
// Peytavie2009, section 4.2: the tool's volume is taken out of the terrain as a Boolean difference (swept.cpp says how, and why the printed formula
// needs a shift); the layers are updated along the axes of the columns. With mode = "add" it is put in instead, a union: an arch is swept through
// air.
//
// CHOICES: the difference is with all materials (`removes` names fewer); columns lose exactly what lies in the tool, not what the smoothed field
// says, so that edges elsewhere keep their bits. A round tool needs no profile: `points` and `radius`. A skeleton that crosses itself without a node
// there is an error, not a guess. Missing: sections that avoid what is there already.
#include "terrain/edit/sweep.h"

#include "terrain/edit/aim.h"
#include "terrain/edit/rows.h"
#include "terrain/edit/sweep_scene.h"
#include "terrain/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

void check_skeleton(const SweepTool& tool, const MaterialStack& stack, const Values& edit)
{
    std::optional<Vec3d> along;
    if (edit.boolean("project")) {
        if (!(edit.vec3("along").length() > 0.0)) throw edit.problem("along", "a direction", "one number at least that is not 0");
        along = edit.vec3("along").normalized();
    }
    const auto crossing = find_crossing(tool.skeleton, tool.smooth, 0.01 * stack.cell(), along);
    if (!crossing) return;
    const std::string where = fmt::format("({:.6g}, {:.6g}, {:.6g}) m", crossing->at.x, crossing->at.y, crossing->at.z);
    if (crossing->arc != crossing->other) {
        throw edit.problem("arc", "the skeleton crosses itself", "a common node where arcs meet",
                           fmt::format("arcs {} and {} at {}", crossing->arc, crossing->other, where));
    }
    throw edit.problem(edit.points("points").empty() ? "arc" : "points", "the skeleton crosses itself", "a node there, or another way", where);
}

/// The tool must meet the space that the stack can hold.
void check_place(const std::vector<std::vector<Ring>>& tubes, const MaterialStack& stack, const Values& edit)
{
    Box3d box;
    for (const auto& tube : tubes) {
        for (const Ring& ring : tube) {
            for (const Vec3d& p : ring.corners) box.extendBy(p);
        }
    }
    const Vec3d size(stack.size().x * stack.cell(), stack.size().y * stack.cell(), MaterialStack::max_top * stack.unit());
    const Box3d space(stack.origin(), stack.origin() + size);
    if (box.intersects(space)) return;
    const auto text = [](const Box3d& b) {
        return fmt::format("x in [{:.6g}, {:.6g}], y in [{:.6g}, {:.6g}], z in [{:.6g}, {:.6g}] m", b.min.x, b.max.x, b.min.y, b.max.y, b.min.z,
                           b.max.z);
    };
    throw edit.problem(edit.points("points").empty() ? "node" : "points", "the tool lies outside the terrain", "a part of it within " + text(space),
                       text(box));
}

ColumnSet apply_runs(MaterialStack& stack, const std::vector<AxisRuns>& axes, MaterialSet what, Material into)
{
    std::vector<std::uint32_t> columns;
    for (const AxisRuns& axis : axes) columns.push_back(axis.column);
    return change_listed(stack, columns,
                         [&](std::size_t place, const std::vector<Layer>& column) { return overwrite(column, axes[place].runs, what, into); });
}

ColumnSet apply_sweep(MaterialStack& stack, const Values& edit, const EditContext& context)
{
    const SweepTool tool = read_sweep(edit, context.seed);
    check_skeleton(tool, stack, edit);
    const ConvolutionField field(bedrock_of(stack), kernel_of(stack, edit, context));
    const char* key = edit.points("points").empty() ? "node" : "points";
    Projection projection;
    if (edit.boolean("project")) projection = [&](const Vec3d& p) { return onto_surface(field, edit, key, p); };

    ColumnSet changed(stack.size());
    placed(edit, key, [&] {
        const auto tubes = sweep_rings(tool, stack.cell(), &field, projection);
        check_place(tubes, stack, edit);
        if (edit.text("mode") == "carve") {
            MaterialSet removes = 0;
            for (const std::string& name : edit.names("removes"))
                removes = static_cast<MaterialSet>(removes | material_set({material_from_name(name)}));
            changed = apply_runs(stack, swept_runs(stack, tubes, MaterialStack::max_top), removes, Material::air);
        } else {
            // Higher than the stack can hold, so that what rises over it is refused and not cut off.
            changed = apply_runs(stack, swept_runs(stack, tubes, 1 << 20), kEverything, material_from_name(edit.text("material")));
        }
    });
    return changed;
}

}  // namespace

EditTool sweep_tool()
{
    return {sweep_schema(), apply_sweep};
}

}  // namespace hoodoo
