// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/archive.hpp"

#include "io/files.hpp"
#include "io/message.hpp"

#include <algorithm>
#include <bit>
#include <cstdio>
#include <filesystem>
#include <utility>
#include <vector>

namespace hilda::io {

namespace {

static_assert(std::endian::native == std::endian::little, "archives are little endian");

constexpr std::size_t letters_size = 8, number_size = sizeof(std::uint64_t),
                      header_size = letters_size + 2 * number_size;

std::uint64_t number_at(std::string_view bytes, std::size_t at)
{
    std::uint64_t n = 0;
    std::memcpy(&n, bytes.data() + at, number_size);
    return n;
}

bool exists(const std::string& file)
{
    std::error_code error;
    return std::filesystem::exists(file, error);
}

}  // namespace

std::uint64_t checksum(const char* bytes, std::size_t count)
{
    return checksum(0xcbf29ce484222325u, bytes, count);
}

std::uint64_t checksum(std::uint64_t h, const char* bytes, std::size_t count)
{
    const auto take = [&](std::uint64_t w) { h = (h ^ w) * 0x100000001b3u, h ^= h >> 29; };
    for (; count >= 8; bytes += 8, count -= 8) {
        std::uint64_t w = 0;
        std::memcpy(&w, bytes, 8);
        take(w);
    }
    for (; count > 0; ++bytes, --count) take(static_cast<unsigned char>(*bytes));
    return h;
}

Archive::Archive(const Format& format) : has_format(true)
{
    out.append(format.letters, letters_size);
    std::uint64_t version = format.version, length = 0;
    value(version), value(length);
}

Archive::Archive(const Format& format, std::string_view bytes, std::string name)
    : file(std::move(name)), reading(true)
{
    const std::string_view letters(format.letters, letters_size);
    if (!bytes.starts_with(letters)) {
        std::string got(bytes.substr(0, letters_size));
        std::replace_if(
            got.begin(), got.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
        throw damaged("the header is not that of a checkpoint, which begins with '" + std::string(letters) +
                      "', got '" + got + '\'');
    }
    if (bytes.size() < header_size + number_size)
        throw damaged("it must have at least " + std::to_string(header_size + number_size) + " bytes, got " +
                      std::to_string(bytes.size()));
    if (const std::uint64_t length = number_at(bytes, letters_size + number_size); length != bytes.size())
        throw damaged("its length must be " + std::to_string(length) + " bytes, got " +
                      std::to_string(bytes.size()));
    if (const std::uint64_t version = number_at(bytes, letters_size); version != format.version)
        throw IoError(file + ": the checkpoint has format " + std::to_string(version) +
                      "; this program reads format " + std::to_string(format.version));
    const std::size_t end = bytes.size() - number_size;
    if (const std::uint64_t sum = checksum(bytes.data(), end); number_at(bytes, end) != sum)
        throw damaged("wrong checksum, it must be " + std::to_string(sum) + ", got " +
                      std::to_string(number_at(bytes, end)));
    in = bytes.substr(header_size, end - header_size);
    next = last = header_size, has_format = true;
}

Archive::Archive(const Format& format, std::uint64_t length, const Append* to)
    : append(to), in_pieces(true), has_format(true)
{
    out.append(format.letters, letters_size);
    std::uint64_t version = format.version;
    value(version), value(length);
}

void Archive::write(const Format& format, const std::function<void(Archive&)>& write, const Append& append)
{
    Archive length(format, 0, nullptr);
    write(length);
    Archive a(format, length.passed_on + length.out.size() + number_size, &append);
    write(a);
    a.pass_on();
    a.value(a.sum);
    a.pass_on();
}

/// Passes the bytes written so far on.
void Archive::pass_on()
{
    if (append != nullptr) {
        sum = checksum(sum, out.data(), out.size());
        (*append)(out);
    }
    passed_on += out.size();
    out.clear();
}

void Archive::raw(void* at, std::size_t n)
{
    if (!reading) {
        const auto* bytes = static_cast<const char*>(at);
        while (in_pieces && out.size() + n >= piece) {
            const std::size_t part = piece - out.size();
            out.append(bytes, part);
            bytes += part, n -= part;
            pass_on();
        }
        out.append(bytes, n);
        return;
    }
    last = next;
    if (in.size() < n)
        throw damaged("unexpected end of data, " + std::to_string(n) + " bytes must follow, got " +
                          std::to_string(in.size()),
                      last);
    if (n > 0) std::memcpy(at, in.data(), n);
    in.remove_prefix(n);
    next += n;
}

void Archive::count(std::size_t& n, std::size_t bytes)
{
    auto wide = static_cast<std::uint64_t>(n);
    value(wide);
    check(wide <= in.size() / bytes, "invalid length of a list, got " + std::to_string(wide));
    n = wide;
}

void Archive::map(std::map<std::string, std::string>& entries)
{
    std::vector<std::pair<std::string, std::string>> pairs(entries.begin(), entries.end());
    std::size_t n = pairs.size();
    count(n, 2 * number_size);
    pairs.resize(n);
    for (auto& [key, text] : pairs) list(key), list(text);
    entries = {pairs.begin(), pairs.end()};
}

std::string Archive::bytes()
{
    if (has_format) {
        const std::uint64_t length = out.size() + number_size;
        std::memcpy(out.data() + letters_size + number_size, &length, number_size);
        std::uint64_t sum = checksum(out.data(), out.size());
        value(sum);
    }
    return std::move(out);
}

bool CheckpointFiles::exist() const { return exists(last) || exists(before); }

void CheckpointFiles::save(const std::string& bytes)
{
    save([&](const Append& append) { append(bytes); });
}

void CheckpointFiles::save(const std::function<void(const Append&)>& content)
{
    const std::string next = last + ".new";
    write_file(next, content);
    if (exists(last) && !last_is_rejected) rename_file(last, before);
    rename_file(next, last);
    last_is_rejected = false;
}

bool CheckpointFiles::load(const std::function<void(const std::string& bytes, const std::string& file)>& read)
{
    constexpr std::size_t most = std::size_t{1} << 40;
    std::string damage;
    for (const std::string& file : {last, before, final}) {
        if (!exists(file)) continue;
        try {
            read(read_file(file, most), file);
        } catch (const IoError& error) {
            if (damage.empty()) damage = error.what();
            last_is_rejected = last_is_rejected || file == last;
            continue;
        }
        if (!damage.empty()) warning(damage + "; the run continues from the one before");
        return true;
    }
    if (!damage.empty()) throw IoError(damage);
    return false;
}

void CheckpointFiles::save_final(const std::function<void(const Append&)>& content) const
{
    write_file(final, content);
}

void CheckpointFiles::remove_unfinished() const
{
    // In this order: a run that is killed here has its last checkpoint.
    for (const std::string& file : {before, last, last + ".new", last + ".new.tmp"})
        std::remove(file.c_str());
}

void CheckpointFiles::remove() const
{
    remove_unfinished();
    std::remove(final.c_str());
}

}  // namespace hilda::io
