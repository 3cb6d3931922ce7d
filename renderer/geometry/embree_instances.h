// Copies of shared meshes inside Embree: one small tree a mesh, one box an instance. Only for the files that include Embree.
#pragma once

#include "renderer/geometry/embree_query.h"

#include <vector>

namespace hoodoo
{

class EmbreeInstances
{
public:
    /// `instances` must outlive it. Builds the meshes' own trees.
    EmbreeInstances(RTCDevice device, const Instances& instances, std::uint32_t object);
    ~EmbreeInstances();
    EmbreeInstances(const EmbreeInstances&) = delete;
    EmbreeInstances& operator=(const EmbreeInstances&) = delete;

    /// A geometry with one primitive an instance, boxes around `world_origin`, grown by `padding`. Keeps a pointer to this object.
    RTCGeometry geometry(RTCDevice device, const Vec3d& world_origin, double padding);
    /// The same to a geometry that is there already, for the instances that there are now.
    void update(RTCGeometry geometry, const Vec3d& world_origin, double padding);

    std::uint32_t object() const { return object_; }
    /// How far a point found on a triangle may lie from the mesh as given, in the mesh's space.
    double error(std::uint32_t mesh) const { return meshes_[mesh].error; }

private:
    struct Mesh {
        RTCScene scene = nullptr;
        Box3d box;
        Vec3d centre{0.0};  ///< Embree's origin
        double radius = 0.0;
        double error = 0.0;
    };
    static void bounds(const RTCBoundsFunctionArguments* args);
    static void intersect(const RTCIntersectFunctionNArguments* args);
    static void occluded(const RTCOccludedFunctionNArguments* args);
    bool clip(std::uint32_t index, const Ray& ray, double t_max, Ray& local, double& scale, double& shift, RTCRay& out) const;

    const Instances& instances_;
    std::uint32_t object_;
    std::vector<Mesh> meshes_;
    Vec3d world_origin_{0.0};
    double padding_ = 0.0;
};

}  // namespace hoodoo
