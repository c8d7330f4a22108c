// What the libraries that read pictures say by themselves.
#pragma once

namespace poecal {

/// Has OpenCV say nothing of pictures that it cannot read, in the whole process: a program that names each of them itself calls it once.
void silenceDecoders();

}  // namespace poecal
