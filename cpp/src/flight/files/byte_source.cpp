// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/byte_source.hpp"

#include <fmt/format.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <new>
#include <optional>
#include <system_error>
#include <vector>

#include "base/stop.hpp"
#include "flight/files/sha256.hpp"
#include "sepcal/error.hpp"

namespace sepcal::files {
namespace {

constexpr std::size_t packed_chunk = std::size_t{1} << 16U;

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

class FileBytes final : public Bytes {
 public:
  FileBytes(const std::string& file, FileProgress& progress) : file_(file), progress_(progress) {
    std::error_code ignored;
    const auto status = std::filesystem::status(file, ignored);
    if (status.type() == std::filesystem::file_type::not_found) {
      throw Error(file + ": no such file");
    }
    if (std::filesystem::is_directory(status)) {
      throw Error(file + ": is a folder; name a CSV file in it");
    }
    stream_.reset(std::fopen(file.c_str(), "rb"));
    if (!stream_) throw Error(file + ": can't be read: " + std::strerror(errno));
    std::setvbuf(stream_.get(), nullptr, _IONBF, 0);
    if (std::filesystem::is_regular_file(status)) {
      const auto size = std::filesystem::file_size(file, ignored);
      if (!ignored) progress_.total = size;
    }
  }

 private:
  /// A signal that interrupts is a time to ask.
  std::size_t pull(char* to, std::size_t most) override {
    while (progress_.sha256.empty()) {
      base::heed_stop();
      errno = 0;
      const std::size_t count = std::fread(to, 1, most, stream_.get());
      const int error = errno;
      if (std::ferror(stream_.get()) != 0) {
        if (error != EINTR) throw Error(file_ + ": can't be read: " + std::strerror(error));
        std::clearerr(stream_.get());
        if (count == 0) continue;
      }
      hash_.absorb(to, count);
      progress_.read += count;
      if (std::feof(stream_.get()) != 0) progress_.sha256 = hash_.finish();
      return count;
    }
    return 0;
  }

  std::string file_;
  FileProgress& progress_;
  std::unique_ptr<std::FILE, CloseFile> stream_;
  Sha256 hash_;
};

/// Bytes that are made of others, which come in chunks.
class Unpacked : public Bytes {
 public:
  Unpacked(std::string file, std::unique_ptr<Bytes> packed)
      : file_(std::move(file)), packed_(std::move(packed)), chunk_(packed_chunk) {}

 protected:
  /// Whether there are bytes of the chunk left, or of the next one.
  bool refill() {
    if (first_ < last_) return true;
    first_ = 0;
    last_ = packed_->read(chunk_.data(), chunk_.size());
    return last_ > 0;
  }
  std::size_t left() const { return last_ - first_; }
  char* at() { return chunk_.data() + first_; }
  void take(std::size_t count) { first_ += count; }

  [[noreturn]] void fail_broken(const char* packer, const char* tool) const {
    throw Error(fmt::format(
        "{}: its {} data breaks off or is damaged; '{} FILE > flight.csv' unpacks what there is",
        file_, packer, tool));
  }

 private:
  std::string file_;
  std::unique_ptr<Bytes> packed_;
  std::vector<char> chunk_;
  std::size_t first_ = 0;
  std::size_t last_ = 0;
};

class GzipBytes final : public Unpacked {
 public:
  using Unpacked::Unpacked;
  GzipBytes(const GzipBytes&) = delete;
  GzipBytes& operator=(const GzipBytes&) = delete;
  ~GzipBytes() override { inflateEnd(&stream_); }

 private:
  std::size_t pull(char* to, std::size_t most) override {
    stream_.next_out = reinterpret_cast<Bytef*>(to);  // NOLINT: zlib's type
    stream_.avail_out = static_cast<uInt>(std::min<std::size_t>(most, 1U << 30U));
    const uInt asked = stream_.avail_out;
    while (stream_.avail_out == asked) {
      if (!refill()) {
        if (inside_) fail_broken("gzip", "zcat");
        break;
      }
      if (!inside_) {  // one member after the other
        if (inflateInit2(&stream_, 16 + MAX_WBITS) != Z_OK) throw std::bad_alloc();
        inside_ = true;
      }
      stream_.next_in = reinterpret_cast<Bytef*>(at());  // NOLINT: zlib's type
      stream_.avail_in = static_cast<uInt>(left());
      const int done = inflate(&stream_, Z_NO_FLUSH);
      take(left() - stream_.avail_in);
      if (done == Z_STREAM_END) {
        inflateEnd(&stream_);
        inside_ = false;
      } else if (done != Z_OK && done != Z_BUF_ERROR) {
        fail_broken("gzip", "zcat");
      }
    }
    return asked - stream_.avail_out;
  }

  z_stream stream_ = {};
  bool inside_ = false;  // a member
};

class ZstdBytes final : public Unpacked {
 public:
  using Unpacked::Unpacked;

 private:
  struct Free {
    void operator()(ZSTD_DStream* stream) const { ZSTD_freeDStream(stream); }
  };

  std::size_t pull(char* to, std::size_t most) override {
    ZSTD_outBuffer out{to, most, 0};
    while (out.pos == 0) {
      const bool more = refill();
      if (!more && ended_) break;
      ZSTD_inBuffer in{at(), left(), 0};
      const std::size_t state = ZSTD_decompressStream(stream_.get(), &out, &in);
      take(in.pos);
      ended_ = state == 0;
      if (ZSTD_isError(state) != 0 || (!more && out.pos == 0 && !ended_)) {
        fail_broken("Zstandard", "zstdcat");
      }
    }
    return out.pos;
  }

  std::unique_ptr<ZSTD_DStream, Free> stream_{ZSTD_createDStream()};
  bool ended_ = true;  // no frame is open
};

/// UTF-16 as UTF-8; half a character is U+FFFD, the mark of order nothing.
class Utf16Bytes final : public Unpacked {
 public:
  Utf16Bytes(std::string file, std::unique_ptr<Bytes> wide, bool big_endian)
      : Unpacked(std::move(file), std::move(wide)), big_endian_(big_endian) {}

 private:
  static constexpr std::size_t longest = 4;  // bytes of a character

  std::size_t pull(char* to, std::size_t most) override {
    std::size_t count = 0;
    while (count + 2 * longest <= most && refill()) {
      const unsigned byte = static_cast<unsigned char>(*at());
      take(1);
      if (!half_) {
        half_ = byte;
        continue;
      }
      const char32_t unit = big_endian_ ? (*half_ << 8U) + byte : (byte << 8U) + *half_;
      half_.reset();
      count += put(unit, to + count);
    }
    return count;
  }

  std::size_t put(char32_t unit, char* to) {
    constexpr char32_t unknown = 0xFFFD;
    const bool is_high = unit >= 0xD800 && unit < 0xDC00;
    const bool is_low = unit >= 0xDC00 && unit < 0xE000;
    std::size_t count = 0;
    if (high_ != 0 && !is_low) count = encode(unknown, to);
    if (is_low) unit = high_ != 0 ? 0x10000 + ((high_ - 0xD800) << 10U) + (unit - 0xDC00) : unknown;
    high_ = is_high ? unit : 0;
    if (is_high || unit == 0xFEFF) return count;
    return count + encode(unit, to + count);
  }

  static std::size_t encode(char32_t c, char* to) {
    if (c < 0x80) {
      to[0] = static_cast<char>(c);
      return 1;
    }
    const std::size_t length = c < 0x800 ? 2 : c < 0x10000 ? 3 : 4;
    for (std::size_t i = length - 1; i > 0; --i, c >>= 6U) {
      to[i] = static_cast<char>(0x80U | (c & 0x3FU));
    }
    constexpr std::array<unsigned char, 5> leads{0, 0, 0xC0, 0xE0, 0xF0};
    to[0] = static_cast<char>(leads[length] | c);
    return length;
  }

  bool big_endian_;
  std::optional<unsigned> half_;
  char32_t high_ = 0;
};

/// Which half of each 16 bits is the high one: by a mark of order, or as nearly all of the text's
/// characters are below 256 there.
std::optional<bool> find_utf16(std::string_view text) {
  if (text.starts_with("\xFF\xFE")) return false;
  if (text.starts_with("\xFE\xFF")) return true;
  constexpr std::size_t least = 16;
  if (text.size() < least) return std::nullopt;
  std::array<std::size_t, 2> zeros{};
  for (std::size_t i = 0; i < text.size(); ++i) zeros[i % 2] += text[i] == '\0' ? 1U : 0U;
  const std::size_t most = text.size() * 2 / 5;
  if (zeros[1] > most && zeros[0] == 0) return false;
  if (zeros[0] > most && zeros[1] == 0) return true;
  return std::nullopt;
}

}  // namespace

std::size_t Bytes::read(char* to, std::size_t most) {
  if (given_ == ahead_.size()) return pull(to, most);
  const std::size_t count = std::min(most, ahead_.size() - given_);
  std::copy_n(ahead_.data() + given_, count, to);
  given_ += count;
  return count;
}

std::string_view Bytes::peek(std::size_t count) {
  ahead_.erase(0, given_);
  given_ = 0;
  while (ahead_.size() < count) {
    const std::size_t had = ahead_.size();
    ahead_.resize(had + packed_chunk);
    const std::size_t came = pull(ahead_.data() + had, packed_chunk);
    ahead_.resize(had + came);
    if (came == 0) break;
  }
  return ahead_;
}

ByteSource::ByteSource(const std::string& file)
    : file_(file), bytes_(std::make_unique<FileBytes>(file, progress_)) {
  constexpr std::size_t seen = 512;
  if (bytes_->peek(seen).starts_with("\x1F\x8B\x08")) {
    bytes_ = std::make_unique<GzipBytes>(file, std::move(bytes_));
    packed_ = true;
  } else if (bytes_->peek(seen).starts_with("\x28\xB5\x2F\xFD")) {
    bytes_ = std::make_unique<ZstdBytes>(file, std::move(bytes_));
    packed_ = true;
  }
  if (const auto big_endian = find_utf16(bytes_->peek(seen).substr(0, seen))) {
    bytes_ = std::make_unique<Utf16Bytes>(file, std::move(bytes_), *big_endian);
    encoding_ = "UTF-16";
  }
}

ByteSource::~ByteSource() = default;

std::size_t ByteSource::read(char* to, std::size_t most) {
  constexpr std::uint64_t much = std::uint64_t{1} << 30U;
  constexpr std::uint64_t times = 100;
  const std::size_t count = bytes_->read(to, most);
  unpacked_ += count;
  if (packed_ && unpacked_ > much && unpacked_ > times * progress_.read) {
    throw Error(fmt::format(
        "{}: unpacks to more than 1 GiB and to over a hundred times its size; if it is a log, "
        "unpack it first",
        file_));
  }
  return count;
}

std::string_view ByteSource::peek(std::size_t count) { return bytes_->peek(count); }

}  // namespace sepcal::files
