// The kinds of effects, each in a file of its name; the catalogue lists them in the contract's order.
#pragma once

#include "poecal/effects/catalogue.hpp"

namespace poecal::kinds {

EffectKind jointGain();
EffectKind jointEccentricity();
EffectKind jointHarmonic();
EffectKind jointCompliance();
EffectKind jointBacklash();
EffectKind jointHysteresis();
EffectKind jointCoupling();
EffectKind jointSlip();
EffectKind jointDrift();
EffectKind axisWobble();
EffectKind linkBending();
EffectKind linkExpansion();
EffectKind baseCompliance();
EffectKind cameraSlip();
EffectKind cameraDrift();
EffectKind lensDistortion();
EffectKind focalLength();
EffectKind focalDrift();
EffectKind principalPoint();
EffectKind rollingShutter();
EffectKind timeOffset();
EffectKind targetScale();
EffectKind targetAnisotropy();
EffectKind targetBend();
EffectKind targetLayout();
EffectKind targetSlip();
EffectKind cornerBias();
EffectKind jointScatter();
EffectKind badSamples();

}  // namespace poecal::kinds
