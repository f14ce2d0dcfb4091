#include <cstdint>
#include <limits>

#include "modules/config/csv.h"
#include "modules/config/error.h"
#include "testbench/tests/fuzz/target.h"

namespace rtusim::fuzz {
namespace {

std::vector<std::string> seeds() { return {"id,x,note\n7,-1,a b\n8,+2,\n", "x\r\n9223372036854775807\r\n"}; }

void read(const std::filesystem::path& file) {
  const csv_table table(file);
  using whole = std::numeric_limits<std::int64_t>;
  for (std::size_t row = 0; row < table.rows(); ++row) table.number(row, table.column("x"), whole::min(), whole::max());
}

const registered it{{"csv", "table.csv", seeds, read}};

}  // namespace
}  // namespace rtusim::fuzz
