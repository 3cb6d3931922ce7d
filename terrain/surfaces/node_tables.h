// A tree that stands in a scene as a flat list of named tables: found by name, each made once, without circles, none left over.
#pragma once

#include "terrain/error.h"
#include "terrain/schema.h"

#include <fmt/format.h>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace hoodoo
{

/// The row's tables `node`, each with a `name`; the row's `root` names the top, or is empty: the last one. A node may be used twice. Nodes are
/// shared pointers to `T`.
template <class T>
class NodeTables
{
public:
    using Pointer = std::shared_ptr<const T>;

    /// Throws Error (scene) at a name that stands twice.
    explicit NodeTables(const Values& row) : row_(row), tables_(row.tables("node")), built_(tables_.size())
    {
        for (std::size_t n = 0; n < tables_.size(); ++n) {
            const auto [at, fresh] = numbers_.try_emplace(tables_[n].text("name"), n);
            if (!fresh) throw tables_[n].problem("name", "two nodes have one name", "a name of its own", '"' + at->first + '"');
            names_.push_back(at->first);
        }
    }
    virtual ~NodeTables() = default;

    /// The root. Throws Error (scene) at a name that is unknown, a circle, or a node that nothing uses.
    Pointer build_root()
    {
        const std::string& wanted = row_.text("root");
        const std::size_t root = wanted.empty() ? tables_.size() - 1 : find(wanted, row_, "root");
        const Pointer made = node(root);
        for (std::size_t n = 0; n < tables_.size(); ++n)
            if (!built_[n].node)
                throw tables_[n].problem("name", fmt::format("the node \"{}\" is used by nothing", names_[n]),
                                         fmt::format("a node that \"{}\" is made of", names_[root]));
        return made;
    }

protected:
    /// Makes one node of its table; asks for others with part() and parts().
    virtual Pointer make(const Values& table, const std::string& name) = 0;

    Pointer part(const Values& table) { return node(find(table.text("of"), table, "of")); }
    std::vector<Pointer> parts(const Values& table)
    {
        std::vector<Pointer> list;
        for (const std::string& name : table.names("of")) list.push_back(node(find(name, table, "of")));
        return list;
    }

private:
    struct Slot {
        Pointer node;
        bool building = false;
    };

    std::size_t find(const std::string& name, const Values& table, const std::string& key) const
    {
        const auto found = numbers_.find(name);
        if (found != numbers_.end()) return found->second;
        throw Error(ErrorKind::scene, Problem{table.where(key), "there is no node of this name", {}, '"' + name + '"', nearest_name(name, names_)});
    }

    Pointer node(std::size_t n)
    {
        Slot& slot = built_[n];
        if (slot.node) return slot.node;
        if (slot.building) throw tables_[n].problem("name", fmt::format("the node \"{}\" is made of itself", names_[n]), "nodes without a circle");
        slot.building = true;
        slot.node = make(tables_[n], names_[n]);
        slot.building = false;
        return slot.node;
    }

    const Values& row_;
    const std::vector<Values>& tables_;
    std::vector<Slot> built_;
    std::map<std::string, std::size_t> numbers_;
    std::vector<std::string> names_;
};

}  // namespace hoodoo
