/* Pose corrections of the photographs' cameras, six numbers each. The first three, a, rotate the camera about itself;
 * the last three shift it along its uncorrected axes. R is the rotation of the normalised quaternion (1, a / 2), and W
 * the given rotation of the camera. A point x is at R (W (x - eye) - shift) in the corrected camera's frame. */
#ifndef FXS_FIT_POSE_H
#define FXS_FIT_POSE_H

#include "adam.h"

/* Corrects a camera's pose. Its rotation W becomes R W, its eye becomes eye + W^t shift, with the correction's rotation
   R and shift. */
static inline void pose_camera(fxs_fit_camera *camera, const fxs_fit_pose *pose)
{
    const float x = 0.5f * pose->at[0], y = 0.5f * pose->at[1], z = 0.5f * pose->at[2];
    const float inverse = 1.0f / root((1.0f + x * x) + (y * y + z * z));
    const float q[4] = {inverse, x * inverse, y * inverse, z * inverse}, *shift = pose->at + 3;
    float w[9], r[3][3];
    memcpy(w, camera->rotation, sizeof w);
    rotation_of(q, r);
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 3; i++)
            camera->rotation[3 * i + k] = (r[i][0] * w[k] + r[i][1] * w[3 + k]) + r[i][2] * w[6 + k];
        camera->eye[k] += (w[k] * shift[0] + w[3 + k] * shift[1]) + w[6 + k] * shift[2];
    }
}

/* Computes the loss gradient by a pose correction from sums over all Gaussians. The correction is a rotation vector a,
   with matrix R, and a shift; W is the given rotation of the camera. dL/dshift = -W dL/dposition. Rotating the camera
   to exp(omega) R W equals rotating the scene by (R W)^t omega about the eye. So dL/domega = R W dL/dtheta, and omega =
   (da + a / 2 x da) / (1 + |a / 2|^2). */
static inline void pose_gradient(const fxs_fit_camera *given, const fxs_fit_pose *pose, const float sums[FXS_FIT_POSE],
                                 float gradient[FXS_FIT_POSE])
{
    const float a[3] = {0.5f * pose->at[0], 0.5f * pose->at[1], 0.5f * pose->at[2]};
    const float share = 1.0f / ((1.0f + a[0] * a[0]) + (a[1] * a[1] + a[2] * a[2]));
    fxs_fit_camera posed = *given;
    float g[3];
    pose_camera(&posed, pose);
    for (int i = 0; i < 3; i++) {
        const float *rw = posed.rotation + 3 * i, *w = given->rotation + 3 * i;
        g[i] = (rw[0] * sums[3] + rw[1] * sums[4]) + rw[2] * sums[5];
        gradient[3 + i] = -((w[0] * sums[0] + w[1] * sums[1]) + w[2] * sums[2]);
    }
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        gradient[i] = (g[i] - (a[j] * g[k] - a[k] * g[j])) * share;
    }
}

/* Makes a step of Adam for a pose correction. sums: gradients as means over pixels and channels, summed over Gaussians.
   rate: in radians; shifts use rate * depth, which moves the picture about as far. Rotation and shift have one second
   moment each. Moments are divided by the moments of a constant gradient of 1, as bias correction. */
static inline void pose_step(fxs_fit_pose *pose, const fxs_fit_camera *given, const float sums[FXS_FIT_POSE],
                             float rate)
{
    const float rates[2] = {rate, rate * pose->depth}, most_of[2] = {FXS_FIT_TURN_MOST, FXS_FIT_FARTHEST_PLACE};
    float gradient[FXS_FIT_POSE];
    pose_gradient(given, pose, sums, gradient);
    for (int k = 0; k < FXS_FIT_POSE; k++)
        if (!(absolute(gradient[k]) < FXS_FIT_FARTHEST_GRADIENT))
            return;
    pose->of_one[0] = pose->of_one[0] * 0.9f + 0.1f;
    pose->of_one[1] = pose->of_one[1] * 0.999f + 0.001f;
    for (int i = 0; i < 2; i++) {
        const float *g = gradient + 3 * i, square = (g[0] * g[0] + g[1] * g[1]) + g[2] * g[2];
        pose->square[i] = without_tiny(pose->square[i] * 0.999f + square * 0.001f);
        const float share = rates[i] / pose->of_one[0] / (root(pose->square[i] / pose->of_one[1]) + 1e-15f);
        for (int k = 3 * i; k < 3 * i + 3; k++) {
            pose->mean[k] = without_tiny(pose->mean[k] * 0.9f + gradient[k] * 0.1f);
            pose->at[k] = least(most(pose->at[k] - share * pose->mean[k], -most_of[i]), most_of[i]);
        }
    }
}

#endif
