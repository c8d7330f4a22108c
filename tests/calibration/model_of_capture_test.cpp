// A model is taken for a capture of its own cell alone.
#include "poecal/calibration/model_of_capture.hpp"

#include <gmock/gmock.h>

#include "diagnosis/small_cell.hpp"
#include "poecal/core/error.hpp"

namespace poecal {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class ModelOfCapture : public ::testing::Test {
 protected:
  ModelOfCapture() {
    model_.cell = small_.cell;
    model_.target = small_.target;
    capture_.setup = small_.cell.registration.setup;
    capture_.arm = small_.nominal;
    capture_.camera = small_.cell.camera;
    capture_.target = small_.target;
  }
  void expectTaken() const { EXPECT_NO_THROW(requireModelOf(partsOf(capture_), model_, "model.yaml")); }
  void expectRefused(const std::string& message) const {
    EXPECT_THAT([this] { requireModelOf(partsOf(capture_), model_, "model.yaml"); },
                ThrowsMessage<FileError>(HasSubstr("model.yaml:1: " + message)));
  }

  test::SmallCell small_ = test::smallCell(22, 4, 0.1, {});
  Model model_;
  Capture capture_;
};

TEST_F(ModelOfCapture, ThatOfItsCellIsTaken) {
  expectTaken();
  capture_.camera->width = capture_.camera->height = 0;
  expectTaken();
  capture_.camera.reset();  // to be found from pictures
  expectTaken();
}

TEST_F(ModelOfCapture, AnotherSetupIsRefused) {
  capture_.setup = Setup::kEyeInHand;
  expectRefused("its setup is eye_to_hand, expected eye_in_hand as in the capture");
}

TEST_F(ModelOfCapture, OtherPicturesAreRefused) {
  capture_.camera->width *= 2;
  expectRefused("its pictures are ");
}

TEST_F(ModelOfCapture, AnotherTargetIsRefused) {
  capture_.target.points.pop_back();
  expectRefused("its target is not that of the capture");
  capture_.target = small_.target;
  capture_.target.points.back().p_target.x() += 1e-3;
  expectRefused("its target is not that of the capture");
}

TEST_F(ModelOfCapture, AnotherArmIsRefusedOfPosesToo) {
  Joint& joint = capture_.arm->joints[3];
  joint = Joint::revolute(joint.name, joint.axis(), joint.anchor + Eigen::Vector3d(0.3, 0.4, 0.5));
  expectRefused("is a model of ");
  model_.cell.camera.reset();
  model_.target.reset();
  capture_.setup = Setup::kEyeInHand;
  expectRefused("is a model of ");
  capture_.arm = small_.nominal;
  expectTaken();
}

}  // namespace
}  // namespace poecal
