#version 460
// SPDX-License-Identifier: Apache-2.0
// Every path length ray ends here, since the any-hit shader ignores all hits; the sums are complete.
#extension GL_EXT_ray_tracing : require

void main()
{
}
