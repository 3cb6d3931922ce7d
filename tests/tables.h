// Tables of parameters, written in a test as in a scene.
#pragma once

#include "terrain/schema.h"

namespace hoodoo::testing
{

inline Node number(double x)
{
    Node node;
    node.value = x;
    return node;
}

inline Node flag(bool x)
{
    Node node;
    node.value = x;
    return node;
}

[[gnu::noinline]] inline Node text(const std::string& s)  // inlined, it makes GCC 12 warn of a variant it cannot follow
{
    Node node;
    node.value = s;
    return node;
}

/// What stands right of an equals sign: a number, a text, a list of numbers, or a node made before.
struct Item {
    Node node;
    Item(double x) : node(number(x)) {}
    Item(const char* s) : node(text(s)) {}
    Item(const std::string& s) : node(text(s)) {}
    Item(Node n) : node(std::move(n)) {}
    Item(std::initializer_list<double> xs)
    {
        Node::Array array;
        for (const double x : xs) array.push_back(number(x));
        node.value = std::move(array);
    }
};

inline Node table(std::initializer_list<std::pair<const char*, Item>> entries)
{
    Node::Table all;
    for (const auto& [key, item] : entries) all.emplace_back(key, item.node);
    Node node;
    node.value = std::move(all);
    return node;
}

inline Node tables(std::initializer_list<Node> nodes)
{
    Node node;
    node.value = Node::Array(nodes.begin(), nodes.end());
    return node;
}

inline Node list(std::initializer_list<Item> items)
{
    Node::Array array;
    for (const Item& item : items) array.push_back(item.node);
    Node node;
    node.value = std::move(array);
    return node;
}

}  // namespace hoodoo::testing
