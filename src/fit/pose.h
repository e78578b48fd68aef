/* The poses of photographs. A camera with a pose is turned by its first three numbers, a, about the place at its `depth`
 * straight ahead, and that place is moved along the axes that the camera was given by the last three: so that a shift
 * moves the picture and a turn changes the perspective, and each can be found without the other. With P = (0, 0, depth),
 * rotations R of the quaternion (1, a / 2) over its length and W that was given, a point x is in the camera's frame
 * R (W (x - eye) - P - shift) + P. The processor and CUDA compile this same text. */
#ifndef FXS_FIT_POSE_H
#define FXS_FIT_POSE_H

#include "adam.h"

/* Makes a camera as it was given the refined one: R W, and eye + W^t (shift + P - R^t P). Where all numbers of the pose
   are 0, nothing changes. */
static inline void pose_camera(fxs_fit_camera *camera, const fxs_fit_pose *pose)
{
    const float x = 0.5f * pose->at[0], y = 0.5f * pose->at[1], z = 0.5f * pose->at[2];
    const float inverse = 1.0f / root((1.0f + x * x) + (y * y + z * z));
    const float q[4] = {inverse, x * inverse, y * inverse, z * inverse};
    float w[9], r[3][3], moved[3];
    memcpy(w, camera->rotation, sizeof w);
    rotation_of(q, r);
    for (int i = 0; i < 3; i++)
        moved[i] = pose->at[3 + i] + pose->depth * ((i == 2 ? 1.0f : 0.0f) - r[2][i]);
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 3; i++)
            camera->rotation[3 * i + k] = (r[i][0] * w[k] + r[i][1] * w[3 + k]) + r[i][2] * w[6 + k];
        camera->eye[k] += (w[k] * moved[0] + w[3 + k] * moved[1]) + w[6 + k] * moved[2];
    }
}

static inline void cross_of(const float a[3], const float b[3], float out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* m v, of the rows of m */
static inline void rotate(const float m[9], const float v[3], float out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = (m[3 * i] * v[0] + m[3 * i + 1] * v[1]) + m[3 * i + 2] * v[2];
}

/* Of the sums over Gaussians (find_pose_gradient), F = sum of dL/dposition and T = sum of dL/dtheta: dL/dshift = -W F.
   To turn the camera further, to exp(omega) R W, is to turn the scene by (R W)^t omega about the eye, and moves the eye
   about P: dL/domega = R W T - P x R W F. And omega = (da + a / 2 x da) / (1 + |a / 2|^2). */
static inline void pose_gradient(const fxs_fit_camera *given, const fxs_fit_pose *pose, const float sums[FXS_FIT_POSE],
                                 float gradient[FXS_FIT_POSE])
{
    const float half[3] = {0.5f * pose->at[0], 0.5f * pose->at[1], 0.5f * pose->at[2]};
    const float ahead[3] = {0, 0, pose->depth};
    const float share = 1.0f / ((1.0f + half[0] * half[0]) + (half[1] * half[1] + half[2] * half[2]));
    fxs_fit_camera posed = *given;
    float turned[3], pushed[3], along[3], about[3];
    pose_camera(&posed, pose);
    rotate(posed.rotation, sums + 3, turned);
    rotate(posed.rotation, sums, pushed);
    rotate(given->rotation, sums, along);
    cross_of(ahead, pushed, about);
    for (int i = 0; i < 3; i++)
        turned[i] -= about[i];
    cross_of(half, turned, about);
    for (int i = 0; i < 3; i++) {
        gradient[i] = (turned[i] - about[i]) * share;
        gradient[3 + i] = -along[i];
    }
}

/* A step of Adam. `sums`: over the number of pixels and channels. The rate, in radians, is that of turns; of shifts it is
   times the depth, which moves the picture as far as a turn of the camera about itself. The moments are corrected by
   those of a gradient of 1, as each photograph has steps of its own. A gradient that is not finite, or beyond
   FXS_FIT_FARTHEST_GRADIENT, changes nothing. */
static inline void pose_step(fxs_fit_pose *pose, const fxs_fit_camera *given, const float sums[FXS_FIT_POSE], float rate)
{
    float gradient[FXS_FIT_POSE];
    pose_gradient(given, pose, sums, gradient);
    for (int k = 0; k < FXS_FIT_POSE; k++)
        if (!(absolute(gradient[k]) < FXS_FIT_FARTHEST_GRADIENT))
            return;
    pose->of_one[0] = pose->of_one[0] * 0.9f + 0.1f;
    pose->of_one[1] = pose->of_one[1] * 0.999f + 0.001f;
    for (int k = 0; k < FXS_FIT_POSE; k++) {
        const float own = k < 3 ? rate : rate * pose->depth, most_of = k < 3 ? FXS_FIT_TURN_MOST : FXS_FIT_FARTHEST_PLACE;
        pose->mean[k] = without_tiny(pose->mean[k] * 0.9f + gradient[k] * 0.1f);
        pose->square[k] = without_tiny(pose->square[k] * 0.999f + gradient[k] * gradient[k] * 0.001f);
        const float mean = pose->mean[k] / pose->of_one[0], square = pose->square[k] / pose->of_one[1];
        const float at = pose->at[k] - own * mean / (root(square) + 1e-15f);
        pose->at[k] = least(most(at, -most_of), most_of);
    }
}

#endif
