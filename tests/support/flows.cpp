// The flows that tests go through.

#include "tests/support/flows.h"

namespace hoodoo::testing
{

Box3d flow_box()
{
    return {Vec3d(-3.0), Vec3d(3.0)};
}

const std::vector<NamedFlow>& named_flows()
{
    const FlowPtr noise = noise_gradient_flow(Vec3d(0.1, 0.2, 0.3), 2.0, 7), curl = curl_flow(Vec3d(0.3, 0.1, 0.2), 6.0, 2, 0.2, 5);
    const FlowPtr vortex = vortex_flow(Vec3d(0.5, 0.2, 0.0), Vec3d(0, 1, 0.3), 1.5);
    // Fades begin and end between one and ten metres from the eye: within flow_box().
    const auto seen = [](double spread) { return DetailView{Vec3d(-4.0, 0.5, 1.0), spread, 0.2}; };
    static const std::vector<NamedFlow> flows{
        {"rotation", rotation_flow(Vec3d(0.5, 0.2, -0.1), Vec3d(1, 2, 0.5)), 1.2},
        {"vortex", vortex, 1.5},
        {"bulge", bulge_flow(Vec3d(0.2, 0.1, 0.4), 2.0), 0.5},
        {"shear", shear_flow(Vec3d(0, 0, 0.2), Vec3d(0, 0.1, 1), Vec3d(1, 0.5, 0)), 1.0},
        {"vertical", vertical_flow(Vec3d(0.0), 2.0, 3, 0.4, 3), 1.0},
        {"noise", noise, 0.3},
        {"curl", curl, 0.3},
        {"scaled", scaled_flow(curl, -0.7), 0.3},
        {"sum", sum_flow({scaled_flow(curl, 0.5), scaled_flow(vortex, 0.5)}), 0.5},
        {"masked", masked_flow(curl, Box3d(Vec3d(-1, -1, -kInfinity), Vec3d(1.5, 1, 0.5)), 2.0), 0.3},
        {"masked_by_height", masked_flow(noise, Box3d(Vec3d(-kInfinity, -kInfinity, 0.0), Vec3d(kInfinity)), 1.0), 0.3},
        {"drifting", drifting_flow(curl, Vec3d(2.0, -1.0, 0.5)), 0.3},
        {"vertical_fading", vertical_flow(Vec3d(0.0), 2.0, 3, 0.4, 3, seen(0.1)), 1.0},
        {"noise_fading", noise_gradient_flow(Vec3d(0.1, 0.2, 0.3), 2.0, 7, seen(0.15)), 0.3},
        {"curl_fading", curl_flow(Vec3d(0.3, 0.1, 0.2), 6.0, 2, 0.2, 5, seen(0.3)), 0.3},
        {"drifting_fading", drifting_flow(curl_flow(Vec3d(0.3, 0.1, 0.2), 6.0, 2, 0.2, 5, seen(0.25)), Vec3d(2.0, -1.0, 0.5)), 0.3},
        {"drifting_masked", masked_flow(drifting_flow(vortex, Vec3d(0.5, 1.0, 0.0)), Box3d(Vec3d(-2.0), Vec3d(2.0)), 1.5), 0.5},
    };
    return flows;
}

}  // namespace hoodoo::testing
