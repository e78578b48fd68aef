package org.fixsplat;

/** A camera, in the units of the scene. A Camera does not change; its methods return new ones. */
public final class Camera {
    /** Position of the eye, and the point that it looks at, which is the middle of {@link #orbit}. */
    public final double eyeX, eyeY, eyeZ, targetX, targetY, targetZ;
    /** A direction that points up in the picture. */
    public final double upX, upY, upZ;
    /** Field of view across the shorter side of the picture, degrees, 1 to 120. */
    public final double fov;

    public Camera(double eyeX, double eyeY, double eyeZ, double targetX, double targetY, double targetZ, double upX,
                  double upY, double upZ, double fov) {
        this(new double[] {eyeX, eyeY, eyeZ, targetX, targetY, targetZ, upX, upY, upZ, fov});
    }

    Camera(double[] numbers) {
        eyeX = numbers[0];
        eyeY = numbers[1];
        eyeZ = numbers[2];
        targetX = numbers[3];
        targetY = numbers[4];
        targetZ = numbers[5];
        upX = numbers[6];
        upY = numbers[7];
        upZ = numbers[8];
        fov = numbers[9];
    }

    double[] numbers() {
        return new double[] {eyeX, eyeY, eyeZ, targetX, targetY, targetZ, upX, upY, upZ, fov};
    }

    /** Turns the eye about the target: `right` radians about the up direction, then `down` radians towards it. The eye
     *  stays a degree away from the poles. */
    public Camera orbit(double right, double down) {
        final double[] up = unit(new double[] {upX, upY, upZ});
        final double[] away = {eyeX - targetX, eyeY - targetY, eyeZ - targetZ};
        final double[] turned = turn(away, up, -right);
        final double[] side = unit(cross(up, turned));
        final double now = Math.acos(Math.max(-1, Math.min(1, dot(unit(turned), up))));
        final double then = Math.max(Math.PI / 180, Math.min(Math.PI * 179 / 180, now - down));
        final double[] there = turn(turned, side, then - now);
        return moved(new double[] {targetX + there[0], targetY + there[1], targetZ + there[2]},
                     new double[] {targetX, targetY, targetZ});
    }

    /** Moves eye and target, so that the target moves by this share of the picture's shorter side. */
    public Camera pan(double right, double down) {
        final double[] ahead = {targetX - eyeX, targetY - eyeY, targetZ - eyeZ};
        final double[] side = unit(cross(ahead, new double[] {upX, upY, upZ}));
        final double[] below = unit(cross(ahead, side));
        final double size = 2 * Math.sqrt(dot(ahead, ahead)) * Math.tan(Math.toRadians(fov) / 2);
        final double[] eye = {eyeX, eyeY, eyeZ};
        final double[] target = {targetX, targetY, targetZ};
        for (int i = 0; i < 3; i++) {
            final double by = -size * (right * side[i] + down * below[i]);
            eye[i] += by;
            target[i] += by;
        }
        return moved(eye, target);
    }

    /** Divides the distance of the eye from the target by a factor above 0. */
    public Camera zoom(double factor) {
        final double share = 1 / factor;
        return moved(new double[] {targetX + (eyeX - targetX) * share, targetY + (eyeY - targetY) * share,
                                   targetZ + (eyeZ - targetZ) * share},
                     new double[] {targetX, targetY, targetZ});
    }

    private Camera moved(double[] eye, double[] target) {
        return new Camera(eye[0], eye[1], eye[2], target[0], target[1], target[2], upX, upY, upZ, fov);
    }

    private static double dot(double[] a, double[] b) {
        return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    }

    private static double[] cross(double[] a, double[] b) {
        return new double[] {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    }

    private static double[] unit(double[] a) {
        final double length = Math.sqrt(dot(a, a));
        return length > 0 ? new double[] {a[0] / length, a[1] / length, a[2] / length} : new double[] {1, 0, 0};
    }

    /** Rodrigues' formula: turns a vector about an axis of length 1. */
    private static double[] turn(double[] a, double[] axis, double angle) {
        final double[] across = cross(axis, a);
        final double along = dot(axis, a) * (1 - Math.cos(angle));
        final double[] to = new double[3];
        for (int i = 0; i < 3; i++)
            to[i] = a[i] * Math.cos(angle) + across[i] * Math.sin(angle) + axis[i] * along;
        return to;
    }
}
