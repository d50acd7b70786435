// SPDX-License-Identifier: GPL-3.0-or-later
/// Checkpoints: binary archives of typed values, and the files of an output directory that hold them.

#pragma once

#include "io/error.hpp"
#include "io/files.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace hilda::io {

/// 64-bit checksum: a variant of FNV-1a over words of eight bytes and the remaining single bytes, with an
/// additional shift
std::uint64_t checksum(const char* bytes, std::size_t count);
/// Continues the checksum `before` of bytes that precede; their number is a multiple of eight.
std::uint64_t checksum(std::uint64_t before, const char* bytes, std::size_t count);

/// Writes or reads values in a fixed order. One function serves both directions:
///
///     a.value(t), a.list(positions), a.value(count)
///
/// An archive with a format begins with eight letters, the version and the total length [byte], and ends with
/// the checksum of all preceding bytes. Little endian. An archive without a format consists of the values
/// alone.
class Archive {
public:
    struct Format {
        const char* letters;    ///< eight
        std::uint64_t version;  ///< a file of another version is refused
    };

    /// Writes.
    Archive() = default;
    explicit Archive(const Format& format);
    /// Writes the values of `write` with a format and passes the bytes on in pieces, so that they are never
    /// in memory as a whole. `write` is called twice; the first call determines the length.
    static void write(const Format& format, const std::function<void(Archive&)>& write, const Append& append);
    /// Reads. `file` is for the messages; the bytes must outlive the archive. IoError if the letters, the
    /// version, the length or the checksum are wrong.
    Archive(std::string_view bytes, std::string file) : in(bytes), file(std::move(file)), reading(true) {}
    Archive(const Format& format, std::string_view bytes, std::string file);

    bool reads() const { return reading; }
    /// Name of the file in messages
    const std::string& name() const { return file; }

    template <class T>
    void value(T& v)
    {
        static_assert(std::is_trivially_copyable_v<T>);
        raw(&v, sizeof v);
    }

    /// The first n elements of a list; reading sets its length. Returns the length. The elements are plain
    /// data without padding.
    template <class List>
    std::size_t list(List& values, std::size_t n)
    {
        using T = std::remove_reference_t<decltype(*values.data())>;
        static_assert(std::is_trivially_destructible_v<T>);
        count(n, sizeof(T));
        if (reading) values.resize(static_cast<decltype(values.size())>(n));
        raw(const_cast<void*>(static_cast<const void*>(values.data())), n * sizeof(T));
        return n;
    }
    template <class List>
    std::size_t list(List& values)
    {
        return list(values, static_cast<std::size_t>(values.size()));
    }
    void map(std::map<std::string, std::string>& entries);
    /// The length of a list whose elements of at least `bytes` bytes follow
    void count(std::size_t& n, std::size_t bytes);

    /// IoError "FILE: the checkpoint is damaged at byte N: WHAT" if it reads and `valid` is false. N is the
    /// begin of the value or list that was read last.
    void check(bool valid, const std::string& what) const
    {
        if (reading && !valid) throw damaged(what, last);
    }
    /// The same for the elements of the list that was read last; N is the begin of the first one for which
    /// is_valid(element) is false. "WHAT, got " precedes the text shown(element).
    template <class List, class IsValid, class Shown>
    void check_each(const List& values, const std::string& what, const IsValid& is_valid,
                    const Shown& shown) const
    {
        if (!reading) return;
        const auto n = static_cast<std::size_t>(values.size());
        for (std::size_t k = 0; k < n; ++k)
            if (const auto& value = values.data()[k]; !is_valid(value))
                throw damaged(what + ", got " + shown(value), last + k * sizeof value);
    }
    /// Ends reading: IoError if values are left.
    void end() const
    {
        check(in.empty(), "unread bytes after the content, got " + std::to_string(in.size()));
    }
    /// Ends writing and returns the bytes.
    std::string bytes();

private:
    /// Writes an archive of known length in pieces; without `append` only its length is determined.
    Archive(const Format& format, std::uint64_t length, const Append* append);
    void pass_on();
    void raw(void* at, std::size_t n);
    /// `at`: place in the file [byte]; 0: none
    IoError damaged(const std::string& what, std::size_t at = 0) const
    {
        const std::string place = has_format && at > 0 ? " at byte " + std::to_string(at) : "";
        return IoError(file + ": the checkpoint is damaged" + place + ": " + what);
    }

    static constexpr std::size_t piece = 1 << 20;  ///< [byte]; a multiple of a word of the checksum
    const Append* append = nullptr;
    std::uint64_t passed_on = 0, sum = checksum("", 0);  ///< of the pieces
    bool in_pieces = false;

    std::string out;                 ///< written and not yet passed on
    std::string_view in;             ///< not yet read
    std::size_t next = 0, last = 0;  ///< begin of that, and of the value that was read last [byte]
    std::string file;
    bool reading = false, has_format = false;
};

/// The last checkpoint of an unfinished run, `checkpoint`, and the one before it, `checkpoint.1`. At any time
/// at least one of them is complete: one that load() has rejected does not replace the one before. The
/// checkpoint at the end of a run, from which a longer run can continue, is `checkpoint.end`.
class CheckpointFiles {
public:
    explicit CheckpointFiles(const std::string& directory)
        : last(directory + "/checkpoint"), before(last + ".1"), final(last + ".end")
    {}

    /// Whether there are checkpoints of an unfinished run
    bool exist() const;
    /// Writes `checkpoint`; the previous one becomes checkpoint.1. IoError.
    void save(const std::string& bytes);
    /// The same in pieces; see write_file
    void save(const std::function<void(const Append&)>& content);
    /// Calls read(bytes, file) for the last checkpoint. If that throws an IoError, calls it for the one
    /// before, then for that at the end of the run that is extended, with a warning. Returns false if there
    /// is no checkpoint. IoError if none can be read.
    bool load(const std::function<void(const std::string& bytes, const std::string& file)>& read);
    /// Writes `checkpoint.end`. The other checkpoints remain: remove_unfinished(). IoError.
    void save_final(const std::function<void(const Append&)>& content) const;
    /// Removes the checkpoints of the unfinished run.
    void remove_unfinished() const;
    /// Removes all checkpoints.
    void remove() const;

private:
    std::string last, before, final;
    bool last_is_rejected = false;  ///< by load()
};

}  // namespace hilda::io
