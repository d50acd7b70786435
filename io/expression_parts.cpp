// SPDX-License-Identifier: GPL-3.0-or-later
/// Parts of an expression: its switching functions, and its largest parts in one variable.

#include "io/expression.hpp"

#include <algorithm>
#include <span>

namespace hilda::io {

namespace {

using Op = Expression::Op;
using Instruction = Expression::Instruction;

/// Number of values that an instruction takes from the stack
int operands(Op op)
{
    switch (op) {
        case Op::constant:
        case Op::variable:
            return 0;
        case Op::select:
            return 3;
        case Op::add:
        case Op::subtract:
        case Op::multiply:
        case Op::divide:
        case Op::min:
        case Op::max:
            return 2;
        default:
            return 1;
    }
}

using Program = std::vector<Instruction>;

Program joined(std::span<const Instruction> a, std::span<const Instruction> b, const Instruction& last)
{
    Program all(a.begin(), a.end());
    all.insert(all.end(), b.begin(), b.end());
    all.push_back(last);
    return all;
}

/// Calls visit(k, first) for each instruction k of a program; first[n] is the begin of the part that computes
/// its operand n, and the last of them is k.
template <class Visit>
void for_each_operation(std::span<const Instruction> program, const Visit& visit)
{
    std::vector<std::size_t> begin;  // of the parts whose values are on the stack
    for (std::size_t k = 0; k < program.size(); ++k) {
        const auto n = static_cast<std::size_t>(operands(program[k].op));
        std::vector<std::size_t> first(begin.end() - static_cast<std::ptrdiff_t>(n), begin.end());
        begin.resize(begin.size() - n);
        begin.push_back(n == 0 ? k : first[0]);
        first.push_back(k);
        visit(k, first);
    }
}

}  // namespace

std::vector<Expression> Expression::switching_functions(Switches which) const
{
    std::vector<Expression> all;
    for_each_operation(program, [&](std::size_t k, const std::vector<std::size_t>& first) {
        const auto part = [&](std::size_t n) {
            return std::span(program).subspan(first[n], first[n + 1] - first[n]);
        };
        const auto add = [&](Program p) {
            Expression g = *this;
            g.program = std::move(p);
            const bool varies = std::any_of(g.program.begin(), g.program.end(),
                                            [](const Instruction& i) { return i.op == Op::variable; });
            if (varies) all.push_back(std::move(g));
        };
        const std::span<const Instruction> none;
        const Op op = program[k].op;
        if (op == Op::step || op == Op::select) add(Program(part(0).begin(), part(0).end()));
        if (which == Switches::jumps) return;
        if (op == Op::abs || op == Op::sqrt) add(Program(part(0).begin(), part(0).end()));
        if (op == Op::min || op == Op::max) add(joined(part(0), part(1), {Op::subtract}));
        if (op == Op::asin || op == Op::acos)
            for (const double end : {-1., 1.}) {
                const Instruction limit{.op = Op::constant, .c = end};
                add(joined(part(0), std::span(&limit, 1), {Op::subtract}));
            }
    });
    return all;
}

std::vector<Expression> Expression::parts_in(std::size_t variable) const
{
    std::vector<Expression> parts;
    std::vector<std::size_t> begins;
    for_each_operation(program, [&](std::size_t k, const std::vector<std::size_t>& first) {
        const std::size_t begin = first[0];
        bool varies = false, only = true;
        for (std::size_t n = begin; n <= k; ++n)
            if (program[n].op == Op::variable)
                varies = true, only &= program[n].n == static_cast<int>(variable);
        if (!varies || !only) return;
        while (!begins.empty() && begins.back() >= begin) begins.pop_back(), parts.pop_back();
        Expression part = *this;
        part.arity = 1;
        part.program.assign(program.begin() + static_cast<std::ptrdiff_t>(begin),
                            program.begin() + static_cast<std::ptrdiff_t>(k) + 1);
        for (Instruction& i : part.program)
            if (i.op == Op::variable) i.n = 0;
        begins.push_back(begin);
        parts.push_back(std::move(part));
    });
    std::erase_if(parts, [](const Expression& part) { return part.program.size() == 1; });
    return parts;
}

}  // namespace hilda::io
