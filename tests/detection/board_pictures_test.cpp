#include "poecal/detection/board_pictures.hpp"

#include <gmock/gmock.h>

#include "poecal/core/error.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr const char* kBoard = "type: chessboard\ncols: 9\nrows: 6\nsquare: 0.025\n";

TEST(BoardPictures, AFolderWithoutATargetSaysWhichFileIsMissing) {
  const test::TempFolder folder;
  EXPECT_THAT([&] { readBoardPictures(folder.path(), {}); }, ThrowsMessage<FileError>(HasSubstr("target.yaml: no such file")));
}

TEST(BoardPictures, AFolderWithoutPicturesIsAnError) {
  const test::TempFolder folder;
  folder.write("target.yaml", kBoard);
  EXPECT_THAT([&] { readBoardPictures(folder.path(), {}); }, ThrowsMessage<FileError>(HasSubstr(": no pictures, expected")));
}

TEST(BoardPictures, PicturesThatCannotBeReadAreAnErrorOnceThereAreNoOthers) {
  const test::TempFolder folder;
  folder.write("target.yaml", kBoard);
  folder.write("a.png", "not a picture");
  folder.write("b.png", "neither");
  EXPECT_THAT([&] { readBoardPictures(folder.path(), {}); }, ThrowsMessage<FileError>(HasSubstr("none of the 2 pictures can be read")));
}

}  // namespace
}  // namespace poecal
