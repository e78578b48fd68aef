/* The poses of photographs. A camera is turned in its own frame by a, its first three numbers, and moved along its axes
 * as they were given by its last three. The processor and CUDA compile this same text. */
#ifndef FXS_FIT_POSE_H
#define FXS_FIT_POSE_H

#include "adam.h"

/* Makes a camera that was given the refined one: rotation R(a) W, eye + W^t shift, with R of the quaternion (1, a / 2)
   over its length. Poses of 0 change nothing. */
static inline void pose_camera(fxs_fit_camera *camera, const float at[FXS_FIT_POSE])
{
    const float x = 0.5f * at[0], y = 0.5f * at[1], z = 0.5f * at[2];
    const float inverse = 1.0f / root((1.0f + x * x) + (y * y + z * z));
    const float q[4] = {inverse, x * inverse, y * inverse, z * inverse};
    float given[9], r[3][3];
    memcpy(given, camera->rotation, sizeof given);
    rotation_of(q, r);
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 3; i++)
            camera->rotation[3 * i + k] = (r[i][0] * given[k] + r[i][1] * given[3 + k]) + r[i][2] * given[6 + k];
        camera->eye[k] += (given[k] * at[3] + given[3 + k] * at[4]) + given[6 + k] * at[5];
    }
}

/* Of the sums over Gaussians (find_pose_gradient): dL/dshift = -W dL/dposition, with the W that was given. To turn the
   camera's W further, to exp(omega) W, is to turn the scene by W^t omega about the eye, so dL/domega = W dL/dtheta. And
   omega = (da + a / 2 x da) / (1 + |a / 2|^2). */
static inline void pose_gradient(const fxs_fit_camera *given, const float at[FXS_FIT_POSE],
                                 const float sums[FXS_FIT_POSE], float gradient[FXS_FIT_POSE])
{
    const float a[3] = {0.5f * at[0], 0.5f * at[1], 0.5f * at[2]};
    const float share = 1.0f / ((1.0f + a[0] * a[0]) + (a[1] * a[1] + a[2] * a[2]));
    fxs_fit_camera posed = *given;
    float g[3];
    pose_camera(&posed, at);
    for (int i = 0; i < 3; i++) {
        const float *w = posed.rotation + 3 * i, *v = given->rotation + 3 * i;
        g[i] = (w[0] * sums[3] + w[1] * sums[4]) + w[2] * sums[5];
        gradient[3 + i] = -((v[0] * sums[0] + v[1] * sums[1]) + v[2] * sums[2]);
    }
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        gradient[i] = (g[i] - (a[j] * g[k] - a[k] * g[j])) * share;
    }
}

static inline void pose_step(fxs_fit_pose *pose, const fxs_fit_camera *given, const float sums[FXS_FIT_POSE],
                             float turn_rate, float shift_rate)
{
    const float rates[2] = {turn_rate, shift_rate}, most_of[2] = {FXS_FIT_TURN_MOST, FXS_FIT_SHIFT_MOST};
    float gradient[FXS_FIT_POSE], squares[2];
    pose_gradient(given, pose->at, sums, gradient);
    for (int k = 0; k < FXS_FIT_POSE; k++)
        if (!(absolute(gradient[k]) < FXS_FIT_FARTHEST_GRADIENT))
            return;
    for (int i = 0; i < 2; i++) {
        const float *g = gradient + 3 * i;
        squares[i] = (g[0] * g[0] + g[1] * g[1]) + g[2] * g[2];
    }
    pose->of_one[0] = pose->of_one[0] * 0.9f + 0.1f;
    pose->of_one[1] = pose->of_one[1] * 0.999f + 0.001f;
    for (int k = 0; k < FXS_FIT_POSE; k++) {
        const int i = k / 3;
        if (k % 3 == 0)
            pose->square[i] = without_tiny(pose->square[i] * 0.999f + squares[i] * 0.001f);
        const float share = rates[i] / pose->of_one[0] / (root(pose->square[i] / pose->of_one[1]) + 1e-15f);
        pose->mean[k] = without_tiny(pose->mean[k] * 0.9f + gradient[k] * 0.1f);
        pose->at[k] = least(most(pose->at[k] - share * pose->mean[k], -most_of[i]), most_of[i]);
    }
}

#endif
