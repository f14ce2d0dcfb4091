#include "modules/config/input_ledger.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <utility>

#include <fmt/format.h>
#include <nettle/sha2.h>

namespace rtusim::config {
namespace {

namespace fs = std::filesystem;

std::mutex access;
std::vector<input_ledger*> ledgers;  // that live, the last the innermost

fs::path absolute_of(const fs::path& file) {
  std::error_code unknown;
  const fs::path whole = fs::absolute(file, unknown);
  return unknown ? file : whole;
}

fs::path canonical_of(const fs::path& file) {
  std::error_code unknown;
  const fs::path found = fs::canonical(file, unknown);
  return unknown ? absolute_of(file).lexically_normal() : found;
}

}  // namespace

std::string sha256_of(std::string_view bytes) {
  sha256_ctx state;
  sha256_init(&state);
  sha256_update(&state, bytes.size(), reinterpret_cast<const std::uint8_t*>(bytes.data()));
  std::array<std::uint8_t, SHA256_DIGEST_SIZE> digest{};
  sha256_digest(&state, digest.size(), digest.data());
  return fmt::format("{:02x}", fmt::join(digest, ""));
}

input_ledger::input_ledger(keeping what, std::uint64_t most_kept_bytes) : what_(what), room_bytes_(most_kept_bytes) {
  const std::lock_guard<std::mutex> lock(access);
  ledgers.push_back(this);
}

input_ledger::~input_ledger() {
  const std::lock_guard<std::mutex> lock(access);
  ledgers.erase(std::find(ledgers.begin(), ledgers.end(), this));
}

std::vector<input_file> input_ledger::files() const {
  const std::lock_guard<std::mutex> lock(access);
  return files_;
}

std::vector<fs::path> input_ledger::names() const {
  std::vector<fs::path> all;
  for (const input_file& f : files()) all.push_back(f.file);
  return all;
}

void input_ledger::note(const input_file& f) {
  const auto is_same = [&](const input_file& other) {
    return other.file == f.file && other.canonical == f.canonical && other.sha256 == f.sha256;
  };
  if (std::none_of(files_.begin(), files_.end(), is_same)) files_.push_back(f);
}

std::string input_ledger::read_through(const fs::path& file, const std::function<std::string()>& read) {
  const std::lock_guard<std::mutex> lock(access);
  if (ledgers.empty()) return read();
  const fs::path whole = absolute_of(file);
  std::shared_ptr<const kept_file> found;
  for (const input_ledger* l : ledgers)
    if (const auto at = l->kept_.find(whole); at != l->kept_.end() && !found) found = at->second;
  if (!found) {
    auto fresh = std::make_shared<kept_file>();
    fresh->about.canonical = canonical_of(file);
    fresh->bytes = read();
    fresh->about.bytes = fresh->bytes.size();
    fresh->about.sha256 = sha256_of(fresh->bytes);
    found = std::move(fresh);
  }
  input_file about = found->about;
  about.file = file;
  for (input_ledger* l : ledgers) {
    l->note(about);
    if (l->what_ == keeping::bytes && about.bytes <= l->room_bytes_ && l->kept_.emplace(whole, found).second) l->room_bytes_ -= about.bytes;
  }
  return found->bytes;
}

}  // namespace rtusim::config
