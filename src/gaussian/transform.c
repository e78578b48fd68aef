/* Maps Gaussians by affine maps. A covariance is mapped through its factor, the matrix of axes times scales. One-sided
 * Jacobi rotations make the columns of the mapped factor orthogonal again. SH coefficients are rotated by the rotation
 * in the map's polar decomposition. */
#include "transform_internal.h"

#include <string.h>

#include "src/base/exponential.h"
#include "attributes.h"

typedef double matrix[3][3];

/* Computes the SH basis of degrees 1 to 3 in direction d, with the signs of Kerbl et al. 2023 and
   KHR_gaussian_splatting. */
static void sh_basis(double b[15], const double d[3])
{
    const double x = d[0], y = d[1], z = d[2], xx = x * x, yy = y * y, zz = z * z;
    b[0] = -0.4886025119029199 * y;
    b[1] = 0.4886025119029199 * z;
    b[2] = -0.4886025119029199 * x;
    b[3] = 1.0925484305920792 * x * y;
    b[4] = -1.0925484305920792 * y * z;
    b[5] = 0.31539156525252005 * (2 * zz - xx - yy);
    b[6] = -1.0925484305920792 * x * z;
    b[7] = 0.5462742152960396 * (xx - yy);
    b[8] = -0.5900435899266435 * y * (3 * xx - yy);
    b[9] = 2.890611442640554 * x * y * z;
    b[10] = -0.4570457994644658 * y * (4 * zz - xx - yy);
    b[11] = 0.3731763325901154 * z * (2 * zz - 3 * xx - 3 * yy);
    b[12] = -0.4570457994644658 * x * (4 * zz - xx - yy);
    b[13] = 1.445305721320277 * z * (xx - yy);
    b[14] = -0.5900435899266435 * x * (xx - 3 * yy);
}

/* Computes the matrix that rotates SH coefficients: sh[j][k] is the integral over the sphere of Y_j(d) Y_k(R^T d). 4
   Gauss-Legendre nodes in z times 8 azimuths are exact up to degree 7. */
static void rotate_sh(double sh[15][15], matrix r)
{
    static const double node[2] = {0.3399810435848563, 0.8611363115940526};
    static const double weight[2] = {0.6521451548625461, 0.3478548451374538};
    /* cosines of the azimuths 0, pi/4, ... 7 pi/4 */
    static const double cosine[8] = {1, 0x1.6a09e667f3bcdp-1, 0x1.1a62633145c07p-54, -0x1.6a09e667f3bccp-1,
                                     -1, -0x1.6a09e667f3bcep-1, -0x1.a79394c9e8a0ap-53, 0x1.6a09e667f3bcbp-1};
    static const double sine[8] = {0, 0x1.6a09e667f3bccp-1, 1, 0x1.6a09e667f3bcdp-1,
                                   0x1.1a62633145c07p-53, -0x1.6a09e667f3bccp-1, -1, -0x1.6a09e667f3bcep-1};
    const double pi = 3.141592653589793;
    memset(sh, 0, 15 * sizeof *sh);
    for (int i = 0; i < 32; i++) {
        double z = i & 1 ? -node[i >> 1 & 1] : node[i >> 1 & 1], rim = sqrt(1 - z * z);
        double d[3] = {rim * cosine[i >> 2], rim * sine[i >> 2], z}, back[3], y[15], y_back[15];
        for (int k = 0; k < 3; k++)
            back[k] = r[0][k] * d[0] + r[1][k] * d[1] + r[2][k] * d[2];
        sh_basis(y, d);
        sh_basis(y_back, back);
        for (int j = 0; j < 15; j++)
            for (int k = 0; k < 15; k++)
                sh[j][k] += weight[i >> 1 & 1] * pi / 4 * y[j] * y_back[k];
    }
}

static void apply_sh(const fxs_transform *t, float sh[45], int degree)
{
    float old[45];
    memcpy(old, sh, sizeof old);
    for (int l = 1; l <= degree; l++)
        for (int j = l * l - 1; j < l * (l + 2); j++)
            for (int c = 0; c < 3; c++) {
                double sum = 0;
                for (int k = l * l - 1; k < l * (l + 2); k++)
                    sum += t->sh[j][k] * old[3 * k + c];
                sh[3 * j + c] = (float)sum;
            }
}

static double determinant(matrix m)
{
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) + m[0][1] * (m[1][2] * m[2][0] - m[1][0] * m[2][2]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/* Computes R of the polar decomposition m = R S, S symmetric, by X <- (X + X^-T) / 2 (Higham 1986). */
static void polar_rotation(matrix x, matrix m)
{
    memcpy(x, m, sizeof(matrix));
    for (int step = 0; step < 64; step++) {
        double det = determinant(x);
        matrix next;
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
                next[i][j] = (x[i][j] + (x[a][c] * x[b][d] - x[a][d] * x[b][c]) / det) / 2;
            }
        memcpy(x, next, sizeof(matrix));
    }
}

static void quaternion_of(float q[4], matrix m)
{
    double trace = m[0][0] + m[1][1] + m[2][2], most = trace;
    int largest = 0;
    for (int i = 0; i < 3; i++)
        if (m[i][i] > most) {
            most = m[i][i];
            largest = i + 1;
        }
    if (largest == 0) {
        double w = sqrt(fmax(0, 1 + trace)) / 2;
        q[0] = (float)w;
        for (int i = 0; i < 3; i++)
            q[i + 1] = (float)((m[(i + 2) % 3][(i + 1) % 3] - m[(i + 1) % 3][(i + 2) % 3]) / (4 * w));
        return;
    }
    int i = largest - 1, j = (i + 1) % 3, k = (i + 2) % 3;
    double x = sqrt(fmax(0, 1 + m[i][i] - m[j][j] - m[k][k])) / 2;
    q[0] = (float)((m[k][j] - m[j][k]) / (4 * x));
    q[i + 1] = (float)x;
    q[j + 1] = (float)((m[j][i] + m[i][j]) / (4 * x));
    q[k + 1] = (float)((m[k][i] + m[i][k]) / (4 * x));
}

static double dot(matrix m, int i, int j)
{
    return m[0][i] * m[0][j] + m[1][i] * m[1][j] + m[2][i] * m[2][j];
}

static int orthogonalise(matrix m, int i, int j)
{
    double a = dot(m, i, i), b = dot(m, j, j), c = dot(m, i, j);
    if (!(fabs(c) > 1e-13 * sqrt(a * b)))
        return 0;
    double zeta = (b - a) / (2 * c), t = copysign(1, zeta) / (fabs(zeta) + sqrt(1 + zeta * zeta));
    double cosine = 1 / sqrt(1 + t * t), sine = cosine * t;
    for (int row = 0; row < 3; row++) {
        double x = m[row][i], y = m[row][j];
        m[row][i] = cosine * x - sine * y;
        m[row][j] = sine * x + cosine * y;
    }
    return 1;
}

int fxs_transform_init(fxs_transform *transform, double rows[3][4])
{
    matrix rotation;
    double size = 0;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            transform->linear[i][j] = rows[i][j];
            size = fmax(size, fabs(rows[i][j]));
        }
        transform->shift[i] = rows[i][3];
    }
    if (!(fabs(determinant(transform->linear)) > 1e-15 * size * size * size) || !isfinite(size))
        return -1;
    polar_rotation(rotation, transform->linear);
    rotate_sh(transform->sh, rotation);
    return 0;
}

void fxs_set_axes(fxs_gaussian *g, matrix m)
{
    for (int sweep = 0; sweep < 16; sweep++)
        if (!(orthogonalise(m, 0, 1) | orthogonalise(m, 0, 2) | orthogonalise(m, 1, 2)))
            break;
    double sign = copysign(1, determinant(m));
    for (int j = 0; j < 3; j++) {
        double length = sqrt(dot(m, j, j));
        g->scale[j] = fxs_log_scale(length);
        for (int i = 0; i < 3; i++)
            m[i][j] *= sign / length;
    }
    quaternion_of(g->rotation, m);
}

/* Sets a Gaussian's axes from its covariance c, by the Cholesky factor L with L L^T = c. */
void fxs_set_covariance(fxs_gaussian *g, const double c[6], double more)
{
    const double least = 1e-12 * (c[0] + c[1] + c[2]) + more;
    matrix l;
    memset(l, 0, 9 * sizeof(double));
    l[0][0] = sqrt(c[0] + least);
    l[1][0] = c[3] / l[0][0];
    l[2][0] = c[4] / l[0][0];
    l[1][1] = sqrt(fmax(c[1] + least - l[1][0] * l[1][0], least));
    l[2][1] = (c[5] - l[2][0] * l[1][0]) / l[1][1];
    l[2][2] = sqrt(fmax(c[2] + least - l[2][0] * l[2][0] - l[2][1] * l[2][1], least));
    fxs_set_axes(g, l);
}

static void apply_linear(const fxs_transform *t, fxs_gaussian *g)
{
    matrix r, m;
    fxs_rotation_matrix(r, g->rotation[0], g->rotation[1], g->rotation[2], g->rotation[3]);
    for (int j = 0; j < 3; j++) {
        double scale = fxs_exp(g->scale[j]);
        for (int i = 0; i < 3; i++)
            m[i][j] = scale * (t->linear[i][0] * r[0][j] + t->linear[i][1] * r[1][j] + t->linear[i][2] * r[2][j]);
    }
    fxs_set_axes(g, m);
}

void fxs_transform_apply(const fxs_transform *t, fxs_gaussian *g, int sh_degree)
{
    const double x = g->position[0], y = g->position[1], z = g->position[2];
    for (int i = 0; i < 3; i++)
        g->position[i] = (float)(t->linear[i][0] * x + t->linear[i][1] * y + t->linear[i][2] * z + t->shift[i]);
    apply_linear(t, g);
    apply_sh(t, g->sh, sh_degree);
}
