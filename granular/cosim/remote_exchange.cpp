// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/cosim/remote_exchange.hpp"

#include "io/archive.hpp"

#include <cstdint>

namespace hilda::granular {

namespace {

/// Kinds of requests, and of replies: the exit code of the exception, or done
enum class Request : std::uint64_t { tools, open, loads, advance, stiffness, save, close };

void text(io::Archive& a, std::string& s) { a.list(s); }

void transfer(io::Archive& a, std::vector<std::string>& names)
{
    std::uint64_t count = names.size();
    a.value(count);
    names.resize(count);
    for (std::string& name : names) text(a, name);
}

void transfer(io::Archive& a, std::vector<Tool>& tools)
{
    std::uint64_t count = tools.size();
    a.value(count);
    tools.resize(count);
    for (Tool& t : tools) text(a, t.name), a.value(t.mass), a.value(t.place);
}

/// Calls f(archive) that writes, and returns the bytes.
template <class F>
std::string written(const F& f)
{
    io::Archive a;
    f(a);
    return a.bytes();
}

const char* const message_name = "message of an exchange";

template <class T>
std::vector<T> read_list(const std::string& bytes)
{
    io::Archive a(bytes, message_name);
    std::vector<T> list;
    a.list(list);
    return list;
}

}  // namespace

RemoteExchange::RemoteExchange(std::unique_ptr<Channel> of, const std::vector<std::string>& names)
    : channel(std::move(of))
{
    const std::string hello = channel->receive();
    io::Archive in(hello, message_name);
    std::uint64_t version = 0;
    in.value(version);
    if (version != exchange_version)
        throw io::UsageError("the other program must have version " + std::to_string(exchange_version) +
                             " of the exchange, got " + std::to_string(version));
    std::vector<std::string> list = names;
    auto kind = Request::tools;
    const std::string reply = call(written([&](io::Archive& a) { a.value(kind), transfer(a, list); }));
    io::Archive a(reply, message_name);
    a.value(step), transfer(a, all);
}

std::string RemoteExchange::call(const std::string& request)
{
    channel->send(request);
    std::string reply = channel->receive();
    io::Archive a(reply, message_name);
    std::int64_t code = 0;
    a.value(code);
    if (code == io::exit_code::done) return reply.substr(sizeof code);
    std::string status, what;
    text(a, status), text(a, what);
    switch (code) {
        case io::exit_code::invalid_input:
            throw io::InvalidInput(what);
        case io::exit_code::numerical_failure:
            throw io::NumericalFailure(status, what);
        default:
            throw io::Failure(static_cast<int>(code), what);
    }
}

void RemoteExchange::open(const std::vector<ToolBody>& bodies, long steps)
{
    std::vector<ToolBody> list = bodies;
    auto kind = Request::open;
    std::int64_t from = steps;
    call(written([&](io::Archive& a) { a.value(kind), a.list(list), a.value(from); }));
}

std::vector<ToolImpulse> RemoteExchange::loads(const std::vector<ToolMotion>& motions)
{
    std::vector<ToolMotion> list = motions;
    auto kind = Request::loads;
    return read_list<ToolImpulse>(call(written([&](io::Archive& a) { a.value(kind), a.list(list); })));
}

void RemoteExchange::advance(const std::vector<ToolMotion>& motions, long steps, std::vector<ToolImpulse>& to)
{
    std::vector<ToolMotion> list = motions;
    auto kind = Request::advance;
    std::int64_t count = steps;
    to = read_list<ToolImpulse>(
        call(written([&](io::Archive& a) { a.value(kind), a.list(list), a.value(count); })));
}

void RemoteExchange::stiffness(std::vector<ToolStiffness>& to)
{
    auto kind = Request::stiffness;
    to = read_list<ToolStiffness>(call(written([&](io::Archive& a) { a.value(kind); })));
}

void RemoteExchange::save()
{
    auto kind = Request::save;
    call(written([&](io::Archive& a) { a.value(kind); }));
}

void RemoteExchange::close(int code)
{
    auto kind = Request::close;
    std::int64_t with = code;
    call(written([&](io::Archive& a) { a.value(kind), a.value(with); }));
}

void serve(Channel& channel,
           const std::function<std::unique_ptr<Exchange>(const std::vector<std::string>& names)>& make)
{
    channel.send(written([&](io::Archive& a) {
        std::uint64_t version = exchange_version;
        a.value(version);
    }));
    std::unique_ptr<Exchange> grains;
    std::vector<ToolMotion> motions;
    std::vector<ToolImpulse> impulses;
    bool is_open = true;
    /// Reads a request and writes the content of the reply.
    const auto answer = [&](io::Archive& in, io::Archive& out) {
        Request kind{};
        in.value(kind);
        std::int64_t number = 0;
        if (kind == Request::loads || kind == Request::advance) in.list(motions);
        switch (kind) {
            case Request::tools: {
                std::vector<std::string> names;
                transfer(in, names);
                grains = make(names);
                double h = grains->h();
                std::vector<Tool> tools = grains->tools();
                out.value(h), transfer(out, tools);
                break;
            }
            case Request::open: {
                std::vector<ToolBody> bodies;
                in.list(bodies), in.value(number);
                grains->open(bodies, number);
                break;
            }
            case Request::loads: {
                std::vector<ToolImpulse> loads = grains->loads(motions);
                out.list(loads);
                break;
            }
            case Request::advance: {
                in.value(number);
                grains->advance(motions, number, impulses);
                out.list(impulses);
                break;
            }
            case Request::stiffness: {
                std::vector<ToolStiffness> stiffness;
                grains->stiffness(stiffness);
                out.list(stiffness);
                break;
            }
            case Request::save:
                grains->save();
                break;
            case Request::close:
                in.value(number);
                grains->close(static_cast<int>(number));
                is_open = false;
                break;
        }
    };
    while (is_open) {
        const std::string request = channel.receive();
        io::Archive in(request, message_name), out;
        std::int64_t code = io::exit_code::done;
        std::string status, what, content;
        try {
            io::Archive reply;
            answer(in, reply);
            content = reply.bytes();
        } catch (const io::InvalidInput& e) {
            code = io::exit_code::invalid_input, what = e.what();
        } catch (const io::NumericalFailure& e) {
            code = io::exit_code::numerical_failure, status = e.status, what = e.what();
        } catch (const io::Failure& e) {
            code = e.code, what = e.what();
        }
        out.value(code);
        if (code != io::exit_code::done) text(out, status), text(out, what);
        channel.send(out.bytes() + content);
    }
}

}  // namespace hilda::granular
