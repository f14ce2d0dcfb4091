#include "modules/config/csv.h"

#include <catch2/catch.hpp>

#include <cstdint>
#include <filesystem>
#include <fstream>

#include "modules/config/error.h"
#include "modules/config/files.h"
#include "testbench/tests/scratch.h"

namespace rtusim {

TEST_CASE("csv: computed columns take their place, the rest is copied", "[testbench]") {
  const test::scratch_folder folder;
  const auto given = folder.file("in.csv", "id,x,note\r\n7,1,a b\n8,-2,\n");
  const csv_table table(given);
  CHECK(table.rows() == 2);
  CHECK(table.number(1, table.column("x"), -5, 5) == -2);
  write_csv(folder / "out.csv", table, {"id", "x", "y", "z"}, {"y", "z"}, {{10, 11}, {20, 21}});
  CHECK(config::read_file(folder / "out.csv") == "id,x,y,z,note\n7,1,10,11,a b\n8,-2,20,21,\n");
  // Columns that are there keep their place.
  const csv_table again(folder / "out.csv");
  write_csv(folder / "again.csv", again, {"id", "x", "y", "z"}, {"y", "z"}, {{0, 1}, {2, 3}});
  CHECK(config::read_file(folder / "again.csv") == "id,x,y,z,note\n7,1,0,1,a b\n8,-2,2,3,\n");
}

TEST_CASE("csv: tables as other programs write them", "[testbench]") {
  const test::scratch_folder folder;
  const auto file =
      folder.file("t.csv", "\xef\xbb\xbf\"id\", \"the \"\"x\"\"\" ,\tnote\r\n+7, \" 1\" ,\"a, b\"\r\n-8,+2,\"\"\r\n\r\n  \r\n");
  const csv_table table(file);
  REQUIRE(table.rows() == 2);
  CHECK(table.header() == std::vector<std::string>{"id", "the \"x\"", "note"});
  CHECK(table.number(0, table.column("id"), -9, 9) == 7);
  CHECK(table.number(1, table.column("id"), -9, 9) == -8);
  CHECK(table.field(0, 1) == " 1");
  CHECK(table.number(1, 1, -9, 9) == 2);
  CHECK(table.field(0, 2) == "a, b");
  CHECK(table.field(1, 2).empty());
  // What is copied is still the same table.
  write_csv(folder / "out.csv", table, {"id", "y"}, {"y"}, std::vector<std::vector<std::int64_t>>{{3}, {4}});
  CHECK(config::read_file(folder / "out.csv") == "id,y,\"the \"\"x\"\"\",note\n+7,3,\" 1\",\"a, b\"\n-8,4,+2,\n");
}

TEST_CASE("csv: what is no table is refused with its line", "[testbench]") {
  const test::scratch_folder folder;
  const auto message = [&](const std::string& text) -> std::string {
    const auto file = folder.file("t.csv", text);
    try {
      const csv_table table(file);
      table.number(0, table.column("x"), 0, 9);
    } catch (const input_error& e) {
      std::string m = e.what();
      m.erase(0, file.string().size());
      return m;
    }
    return "taken";
  };
  CHECK(message("") == ": an empty file; expected a header line and rows of comma-separated values");
  CHECK(message("id,x\n1\n") == ":2: 1 fields; expected 2, as the header has");
  CHECK(message("id,y\n1,2\n") == ":1: no column x; expected it among the header's");
  CHECK(message("id,x\n1,two\n") == ":2: x = \"two\"; expected a whole number from 0 to 9");
  CHECK(message("id,x\n1,10\n") == ":2: x = \"10\"; expected a whole number from 0 to 9");
  CHECK(message("id,x\n1,+-5\n") == ":2: x = \"+-5\"; expected a whole number from 0 to 9");
  CHECK(message("id,x\n1,+\n") == ":2: x = \"+\"; expected a whole number from 0 to 9");
  CHECK(message("\xef\xbb\xbf\n") == ": an empty file; expected a header line and rows of comma-separated values");
  CHECK(message("id,x\n1,5\n\n2,6\n") == ":3: 1 fields; expected 2, as the header has");
  CHECK(message("id,x\n1,\"5\n6\"\n") == ":2: a quote that does not end in its line; expected another one after the field");
  CHECK(message("id,x\n\"1\"a,5\n") == ":2: a quote that ends within a field; expected a comma after it, or two quotes for one");
  CHECK(message("x,x\n1,5\n") == ":1: two columns x; expected one");
  CHECK(message("id,x\n1,5\n") == "taken");
}

}  // namespace rtusim
