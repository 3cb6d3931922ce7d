// Values at the points of a box-shaped lattice, stored in blocks of 8 x 8 x 8 points, and only where they differ from their neighbours.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace hoodoo
{

using Index3 = std::array<int, 3>;

/// Two levels: nodes of 16^3 blocks, each constant or a table of its blocks, each of them constant or stored. So empty or solid space costs one
/// entry for 128^3 points. Reading is thread-safe; writing is not.
template <class T>
class SparseLattice
{
public:
    static constexpr int kEdge = 8, kNodeEdge = 16, kNodePoints = kEdge * kNodeEdge;
    using Block = std::array<T, 512>;  ///< k runs fastest

    SparseLattice(SparseLattice&&) noexcept = default;
    SparseLattice& operator=(SparseLattice&&) noexcept = default;

    /// A lattice of its own with the same points.
    SparseLattice copy() const
    {
        SparseLattice other(size_, outside_);
        other.stored_ = stored_;
        for (std::size_t n = 0; n < table_.size(); ++n) {
            other.table_[n].constant = table_[n].constant;
            if (!table_[n].cells) continue;
            other.table_[n].cells = std::make_unique<Cells>();
            for (std::size_t c = 0; c < table_[n].cells->size(); ++c) {
                const Cell& from = (*table_[n].cells)[c];
                Cell& to = (*other.table_[n].cells)[c];
                to.constant = from.constant;
                if (from.block) to.block = std::make_unique<Block>(*from.block);
            }
        }
        return other;
    }

    /// `size` points along each axis, at least 1 and at most 2^20; all have the value `everywhere`, and so does every point beyond.
    SparseLattice(const Index3& size, T everywhere) : size_(size), outside_(everywhere)
    {
        for (std::size_t a = 0; a < 3; ++a) {
            blocks_[a] = (size[a] + kEdge - 1) / kEdge;
            nodes_[a] = (blocks_[a] + kNodeEdge - 1) / kNodeEdge;
        }
        table_.resize(static_cast<std::size_t>(nodes_[0]) * static_cast<std::size_t>(nodes_[1]) * static_cast<std::size_t>(nodes_[2]));
        for (Node& node : table_) node.constant = everywhere;
    }

    const Index3& size() const { return size_; }
    const Index3& blocks() const { return blocks_; }  ///< along each axis
    const Index3& nodes() const { return nodes_; }
    T outside() const { return outside_; }

    bool holds(const Index3& p) const { return p[0] >= 0 && p[1] >= 0 && p[2] >= 0 && p[0] < size_[0] && p[1] < size_[1] && p[2] < size_[2]; }
    T at(const Index3& p) const
    {
        if (!holds(p)) return outside_;
        const View cell = view({p[0] / kEdge, p[1] / kEdge, p[2] / kEdge});
        return cell.block ? (*cell.block)[within(p)] : cell.constant;
    }

    /// A block as it is stored: its points, or nullptr and their common value.
    struct View {
        const Block* block;
        T constant;
    };
    /// Blocks beyond the lattice are constant.
    View block(const Index3& b) const
    {
        if (b[0] < 0 || b[1] < 0 || b[2] < 0 || b[0] >= blocks_[0] || b[1] >= blocks_[1] || b[2] >= blocks_[2]) return {nullptr, outside_};
        return view(b);
    }
    /// Whether all of a node is one constant.
    bool constant_node(const Index3& n, T& constant) const
    {
        if (n[0] < 0 || n[1] < 0 || n[2] < 0 || n[0] >= nodes_[0] || n[1] >= nodes_[1] || n[2] >= nodes_[2]) {
            constant = outside_;
            return true;
        }
        const Node& node = table_[node_index(n)];
        constant = node.constant;
        return !node.cells;
    }

    /// The block's points, to be written. Points of it beyond size() stay what `outside` says: do not write them.
    Block& touch(const Index3& b)
    {
        Cell& cell = open(b);
        if (!cell.block) {
            cell.block = std::make_unique<Block>();
            cell.block->fill(cell.constant);
            ++stored_;
        }
        return *cell.block;
    }
    /// Precondition: holds(p).
    void set(const Index3& p, T value)
    {
        const Index3 b{p[0] / kEdge, p[1] / kEdge, p[2] / kEdge};
        Cell& cell = open(b);
        if (!cell.block && cell.constant == value) return;
        touch(b)[within(p)] = value;
    }
    void set_block(const Index3& b, T constant)
    {
        Cell& cell = open(b);
        if (cell.block) --stored_;
        cell.block.reset();
        cell.constant = constant;
    }

    void set_node(const Index3& n, T constant)
    {
        Node& node = table_[node_index(n)];
        if (node.cells) {
            for (const Cell& cell : *node.cells) stored_ -= cell.block != nullptr;
        }
        node.cells.reset();
        node.constant = constant;
    }

    /// Forgets what need not be stored: blocks and nodes whose points are all equal. Blocks that reach beyond the lattice count by the points in it.
    void prune()
    {
        each_block([&](const Index3& b) {
            const View cell = view(b);
            if (!cell.block) return;
            const Block& points = *cell.block;
            const T first = points[0];
            if (every_point(b, [&](std::size_t i) { return points[i] == first; })) set_block(b, first);
        });
        for (Node& node : table_) {
            if (!node.cells) continue;
            const T first = (*node.cells)[0].constant;
            if (std::all_of(node.cells->begin(), node.cells->end(), [&](const Cell& c) { return !c.block && c.constant == first; })) {
                node.constant = first;
                node.cells.reset();
            }
        }
    }

    template <class Visit>
    void each_node(const Visit& visit) const
    {
        for (int x = 0; x < nodes_[0]; ++x)
            for (int y = 0; y < nodes_[1]; ++y)
                for (int z = 0; z < nodes_[2]; ++z) visit(Index3{x, y, z});
    }
    /// visit(b) for every block of a node that lies in the lattice.
    template <class Visit>
    void each_block_of(const Index3& n, const Visit& visit) const
    {
        for (int i = kNodeEdge * n[0]; i < std::min(kNodeEdge * (n[0] + 1), blocks_[0]); ++i)
            for (int j = kNodeEdge * n[1]; j < std::min(kNodeEdge * (n[1] + 1), blocks_[1]); ++j)
                for (int k = kNodeEdge * n[2]; k < std::min(kNodeEdge * (n[2] + 1), blocks_[2]); ++k) visit(Index3{i, j, k});
    }
    /// visit(b) for every block of every node that is not constant.
    template <class Visit>
    void each_block(const Visit& visit) const
    {
        each_node([&](const Index3& n) {
            if (table_[node_index(n)].cells) each_block_of(n, visit);
        });
    }
    /// Whether test(i) holds for all points of the block that lie in the lattice, by their places in it.
    template <class Test>
    bool every_point(const Index3& b, const Test& test) const
    {
        const Index3 n{std::min(kEdge, size_[0] - kEdge * b[0]), std::min(kEdge, size_[1] - kEdge * b[1]), std::min(kEdge, size_[2] - kEdge * b[2])};
        for (int i = 0; i < n[0]; ++i)
            for (int j = 0; j < n[1]; ++j)
                for (int k = 0; k < n[2]; ++k)
                    if (!test(within({i, j, k}))) return false;
        return true;
    }

    static std::size_t within(const Index3& p)
    {
        return (static_cast<std::size_t>(p[0] & 7) << 6) | (static_cast<std::size_t>(p[1] & 7) << 3) | static_cast<std::size_t>(p[2] & 7);
    }

    std::uint64_t stored_blocks() const { return stored_; }
    std::uint64_t memory_bytes() const
    {
        std::uint64_t bytes = table_.size() * sizeof(Node) + stored_ * sizeof(Block);
        for (const Node& node : table_) bytes += node.cells ? sizeof(*node.cells) : 0;
        return bytes;
    }

private:
    struct Cell {
        std::unique_ptr<Block> block;
        T constant;
    };
    using Cells = std::array<Cell, kNodeEdge * kNodeEdge * kNodeEdge>;
    struct Node {
        std::unique_ptr<Cells> cells;
        T constant{};
    };

    std::size_t node_index(const Index3& n) const
    {
        return (static_cast<std::size_t>(n[0]) * static_cast<std::size_t>(nodes_[1]) + static_cast<std::size_t>(n[1])) *
                   static_cast<std::size_t>(nodes_[2]) +
               static_cast<std::size_t>(n[2]);
    }
    static std::size_t cell_index(const Index3& b)
    {
        return static_cast<std::size_t>(((b[0] & 15) * kNodeEdge + (b[1] & 15)) * kNodeEdge + (b[2] & 15));
    }
    View view(const Index3& b) const
    {
        const Node& node = table_[node_index({b[0] / kNodeEdge, b[1] / kNodeEdge, b[2] / kNodeEdge})];
        if (!node.cells) return {nullptr, node.constant};
        const Cell& cell = (*node.cells)[cell_index(b)];
        return {cell.block.get(), cell.constant};
    }
    Cell& open(const Index3& b)
    {
        Node& node = table_[node_index({b[0] / kNodeEdge, b[1] / kNodeEdge, b[2] / kNodeEdge})];
        if (!node.cells) {
            node.cells = std::make_unique<Cells>();
            for (Cell& cell : *node.cells) cell.constant = node.constant;
        }
        return (*node.cells)[cell_index(b)];
    }

    Index3 size_, blocks_{}, nodes_{};
    T outside_;
    std::uint64_t stored_ = 0;
    std::vector<Node> table_;
};

}  // namespace hoodoo
