/* Controllers of OpenXR, and the place of the room in the scene. A grip pulls the scene; two grips turn it about the
 * vertical and scale it. The left thumbstick walks in the direction of view, the right one turns in steps and moves up
 * and down. The viewer of web pages does the same (port/web/viewer/xr.js). */
#include "xr_internal.h"

#ifdef FXS_WITH_OPENXR

#include <math.h>
#include <string.h>

#define METRES_A_SECOND 1.5
#define TURN 0.5235987755982988            /* 30 degrees */
#define PUSHED 0.7                         /* deflection of a thumbstick that starts a turn */
#define IDLE 0.3                           /* deflection below which the next turn is allowed */
#define DEAD 0.15

/* ---- Vectors ----------------------------------------------------------------------------------------------------- */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void add(double to[3], const double by[3], double times)
{
    for (int i = 0; i < 3; i++)
        to[i] += by[i] * times;
}

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static double normalise(double v[3])
{
    const double length = sqrt(dot(v, v));
    for (int i = 0; i < 3 && length > 0; i++)
        v[i] /= length;
    return length;
}

void fxs_xr_turn(const XrQuaternionf *q, const double in[3], double out[3])
{
    const double axis[3] = {q->x, q->y, q->z}, w = q->w;
    double once[3], twice[3];
    cross(axis, in, once);
    cross(axis, once, twice);
    for (int i = 0; i < 3; i++)
        out[i] = in[i] + 2 * (w * once[i] + twice[i]);
}

/* ---- Place ------------------------------------------------------------------------------------------------------- */

/* Turns a vector of the room into the scene's axes. */
static void to_scene(const fxs_xr_place *place, const double v[3], double out[3])
{
    memset(out, 0, 3 * sizeof *out);
    for (int i = 0; i < 3; i++)
        add(out, place->axes[i], v[i]);
}

static void point_in_scene(const fxs_xr_place *place, const double point[3], double out[3])
{
    double turned[3];
    to_scene(place, point, turned);
    memcpy(out, place->origin, sizeof place->origin);
    add(out, turned, place->units);
}

/* Moves the room so that a point of it lies at a point of the scene. */
static void hold(fxs_xr_place *place, const double point[3], const double there[3])
{
    double turned[3];
    to_scene(place, point, turned);
    memcpy(place->origin, there, sizeof place->origin);
    add(place->origin, turned, -place->units);
}

/* Turns the room to the right about the vertical. */
static void turn_by(fxs_xr_place *place, double angle)
{
    const double c = cos(angle), s = sin(angle);
    for (int i = 0; i < 3; i++) {
        const double right = place->axes[0][i], back = place->axes[2][i];
        place->axes[0][i] = c * right + s * back;
        place->axes[2][i] = c * back - s * right;
    }
}

static void head_of(const XrView views[2], double at[3])
{
    const XrVector3f *a = &views[0].pose.position, *b = &views[1].pose.position;
    const double middle[3] = {((double)a->x + b->x) / 2, ((double)a->y + b->y) / 2, ((double)a->z + b->z) / 2};
    memcpy(at, middle, sizeof middle);
}

/* Makes the direction of view level. Steep: takes the upper side of the head instead. */
static void level(const double ahead[3], const double head_up[3], const double up[3], double out[3])
{
    memcpy(out, ahead, 3 * sizeof *out);
    add(out, up, -dot(ahead, up));
    if (normalise(out) >= 0.01)
        return;
    const double sign = dot(ahead, up) > 0 ? -1 : 1;
    for (int i = 0; i < 3; i++)
        out[i] = sign * head_up[i];
    add(out, up, -dot(out, up));
    normalise(out);
}

/* The head's direction in the room becomes the start camera's direction of view; both are level. */
static void place_at_start(fxs_xr *xr, const XrView views[2])
{
    static const double back[3] = {0, 0, -1}, above[3] = {0, 1, 0};
    const fxs_view *start = &xr->start;
    fxs_xr_place *place = &xr->place;
    double up[3], camera_up[3], forward[3], sees[3], head_up[3], looks[3], right[3], head[3];
    for (int i = 0; i < 3; i++) {
        camera_up[i] = -start->rotation[3 + i];
        up[i] = xr->options.up[i];
    }
    if (normalise(up) <= 0)
        memcpy(up, camera_up, sizeof up);
    level(start->rotation + 6, camera_up, up, forward);
    fxs_xr_turn(&views[0].pose.orientation, back, sees);
    fxs_xr_turn(&views[0].pose.orientation, above, head_up);
    level(sees, head_up, above, looks);
    cross(forward, up, right);
    for (int i = 0; i < 3; i++) {
        place->axes[0][i] = looks[0] * forward[i] - looks[2] * right[i];
        place->axes[1][i] = up[i];
        place->axes[2][i] = looks[2] * forward[i] + looks[0] * right[i];
    }
    head_of(views, head);
    hold(place, head, start->position);
}

static void place_room(fxs_xr *xr, const XrView views[2])
{
    static const fxs_xr_place flipped = {.axes = {{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
    if (xr->placed)
        return;
    xr->placed = 1;
    xr->place = flipped;
    xr->place.units = 1 / xr->options.metres_per_unit;
    if (xr->has_start)
        place_at_start(xr, views);
}

int fxs_xr_camera(const fxs_xr *xr, const XrView *view, int32_t width, int32_t height, fxs_camera *camera,
                  fxs_message *why)
{
    static const double axes[3][3] = {{1, 0, 0}, {0, -1, 0}, {0, 0, -1}};      /* of the camera, in OpenXR's axes */
    const double position[3] = {view->pose.position.x, view->pose.position.y, view->pose.position.z};
    const double tangents[4] = {tan(view->fov.angleLeft), tan(view->fov.angleRight), tan(view->fov.angleUp),
                                tan(view->fov.angleDown)};
    fxs_view v = {.width = width, .height = height, .near = FXS_XR_NEAR * xr->place.units};
    double turned[3];
    for (int i = 0; i < 3; i++) {
        fxs_xr_turn(&view->pose.orientation, axes[i], turned);
        to_scene(&xr->place, turned, v.rotation + 3 * i);
    }
    point_in_scene(&xr->place, position, v.position);
    const int error = fxs_view_set_tangents(&v, tangents, why);
    return error ? error : fxs_camera_from_view(camera, &v, why);
}

/* ---- Actions ----------------------------------------------------------------------------------------------------- */

static int make_action(fxs_xr *xr, XrActionType type, const char *name, const char *shown, int of_hands,
                       XrAction *action, fxs_message *why)
{
    XrActionCreateInfo info = {.type = XR_TYPE_ACTION_CREATE_INFO, .actionType = type,
                               .countSubactionPaths = of_hands ? FXS_XR_HANDS : 0, .subactionPaths = xr->hands};
    strcpy(info.actionName, name);
    strcpy(info.localizedActionName, shown);
    return FXS_XR_TRY(CreateAction, (xr->actions, &info, action));
}

static int suggest(fxs_xr *xr, const char *profile, const XrAction *actions, const char *const *paths, uint32_t count,
                   fxs_message *why)
{
    XrActionSuggestedBinding bindings[8];
    XrInteractionProfileSuggestedBinding info = {.type = XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING,
                                                 .countSuggestedBindings = count, .suggestedBindings = bindings};
    int error = FXS_XR_TRY(StringToPath, (xr->instance, profile, &info.interactionProfile));
    for (uint32_t i = 0; i < count && !error; i++) {
        bindings[i].action = actions[i];
        error = FXS_XR_TRY(StringToPath, (xr->instance, paths[i], &bindings[i].binding));
    }
    return error ? error : FXS_XR_TRY(SuggestInteractionProfileBindings, (xr->instance, &info));
}

static int suggest_all(fxs_xr *xr, fxs_message *why)
{
    static const char *const simple[] = {"/user/hand/left/input/select/click", "/user/hand/right/input/select/click",
                                         "/user/hand/left/input/grip/pose", "/user/hand/right/input/grip/pose"};
    static const char *const touch[] = {"/user/hand/left/input/squeeze/value", "/user/hand/right/input/squeeze/value",
                                        "/user/hand/left/input/grip/pose", "/user/hand/right/input/grip/pose",
                                        "/user/hand/left/input/thumbstick", "/user/hand/right/input/thumbstick"};
    static const char *const eyes[] = {"/user/eyes_ext/input/gaze_ext/pose"};
    const XrAction actions[] = {xr->grab, xr->grab, xr->grip, xr->grip, xr->walk, xr->walk};
    int error = suggest(xr, "/interaction_profiles/khr/simple_controller", actions, simple, 4, why);
    error = error ? error : suggest(xr, "/interaction_profiles/oculus/touch_controller", actions, touch, 6, why);
    return error || !xr->gaze
               ? error : suggest(xr, "/interaction_profiles/ext/eye_gaze_interaction", &xr->look, eyes, 1, why);
}

static int make_space(fxs_xr *xr, XrAction action, XrPath of, XrSpace *space, fxs_message *why)
{
    const XrActionSpaceCreateInfo info = {.type = XR_TYPE_ACTION_SPACE_CREATE_INFO, .action = action,
                                          .subactionPath = of, .poseInActionSpace.orientation.w = 1};
    return FXS_XR_TRY(CreateActionSpace, (xr->session, &info, space));
}

int fxs_xr_make_actions(fxs_xr *xr, fxs_message *why)
{
    const XrActionSetCreateInfo set = {.type = XR_TYPE_ACTION_SET_CREATE_INFO, .actionSetName = "scene",
                                       .localizedActionSetName = "Scene"};
    const XrSessionActionSetsAttachInfo attach = {.type = XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO,
                                                  .countActionSets = 1, .actionSets = &xr->actions};
    int error = FXS_XR_TRY(StringToPath, (xr->instance, "/user/hand/left", &xr->hands[FXS_XR_LEFT]));
    error = error ? error : FXS_XR_TRY(StringToPath, (xr->instance, "/user/hand/right", &xr->hands[FXS_XR_RIGHT]));
    error = error ? error : FXS_XR_TRY(CreateActionSet, (xr->instance, &set, &xr->actions));
    error = error ? error : make_action(xr, XR_ACTION_TYPE_BOOLEAN_INPUT, "grab", "Hold the scene", 1, &xr->grab, why);
    error = error ? error : make_action(xr, XR_ACTION_TYPE_POSE_INPUT, "grip", "Hand", 1, &xr->grip, why);
    error = error ? error : make_action(xr, XR_ACTION_TYPE_VECTOR2F_INPUT, "walk", "Walk and turn", 1, &xr->walk, why);
    if (!error && xr->gaze)
        error = make_action(xr, XR_ACTION_TYPE_POSE_INPUT, "look", "Gaze", 0, &xr->look, why);
    error = error ? error : suggest_all(xr, why);
    error = error ? error : FXS_XR_TRY(AttachSessionActionSets, (xr->session, &attach));
    for (int i = 0; i < FXS_XR_HANDS && !error; i++)
        error = make_space(xr, xr->grip, xr->hands[i], &xr->hand[i].space, why);
    return error || !xr->gaze ? error : make_space(xr, xr->look, XR_NULL_PATH, &xr->look_space, why);
}

/* ---- Motion ------------------------------------------------------------------------------------------------------ */

/* Finds a controller or the eyes in the room. Returns 0 if the pose is not valid. */
static int find_pose(fxs_xr *xr, XrSpace space, XrTime time, XrPosef *pose)
{
    const XrSpaceLocationFlags needed = XR_SPACE_LOCATION_POSITION_VALID_BIT | XR_SPACE_LOCATION_ORIENTATION_VALID_BIT;
    XrSpaceLocation location = {.type = XR_TYPE_SPACE_LOCATION};
    fxs_message unused;
    if (fxs_xr_check(xr, xr->call.LocateSpace(space, xr->space, time, &location), "xrLocateSpace", &unused))
        return 0;
    *pose = location.pose;
    return (location.locationFlags & needed) == needed;
}

int fxs_xr_look(fxs_xr *xr, XrTime time, double direction[3])
{
    static const double ahead[3] = {0, 0, -1};
    XrPosef pose;
    if (!xr->look_space || !find_pose(xr, xr->look_space, time, &pose))
        return 0;
    fxs_xr_turn(&pose.orientation, ahead, direction);
    return 1;
}

/* Pulls the scene by one hand, or by the middle of two. Two hands turn and scale it. */
static void pull(fxs_xr_place *place, const fxs_xr_hand before[2], const fxs_xr_hand now[2])
{
    double from[3] = {0}, to[3] = {0}, there[3], apart[2][3] = {{0}};
    const int hands = now[0].grips + now[1].grips;
    if (!hands || before[0].grips != now[0].grips || before[1].grips != now[1].grips)
        return;
    for (int i = 0; i < 2; i++)
        if (now[i].grips) {
            add(from, before[i].at, 1.0 / hands);
            add(to, now[i].at, 1.0 / hands);
            add(apart[0], before[i].at, i ? 1 : -1);
            add(apart[1], now[i].at, i ? 1 : -1);
        }
    point_in_scene(place, from, there);
    if (hands == 2) {
        turn_by(place, atan2(apart[0][2], apart[0][0]) - atan2(apart[1][2], apart[1][0]));
        place->units *= normalise(apart[0]) / fmax(normalise(apart[1]), 0.01);
        place->units = fmin(fmax(place->units, 1e-6), 1e6);
    }
    hold(place, to, there);
}

static double pushed(float x)
{
    return fabs((double)x) < DEAD ? 0 : (double)x;
}

/* Moves the user by the thumbsticks: sticks[hand] is right and up. */
static void walk(fxs_xr *xr, const XrView views[2], const XrVector2f sticks[2], double seconds)
{
    static const double right[3] = {1, 0, 0}, back[3] = {0, 0, 1};
    fxs_xr_place *place = &xr->place;
    double axis[3], turned[3], head[3], there[3];
    const double step = seconds * METRES_A_SECOND * place->units, turn = sticks[FXS_XR_RIGHT].x;
    fxs_xr_turn(&views[0].pose.orientation, right, turned);
    to_scene(place, turned, axis);
    add(place->origin, axis, pushed(sticks[FXS_XR_LEFT].x) * step);
    fxs_xr_turn(&views[0].pose.orientation, back, turned);
    to_scene(place, turned, axis);
    add(place->origin, axis, -pushed(sticks[FXS_XR_LEFT].y) * step);
    add(place->origin, place->axes[1], pushed(sticks[FXS_XR_RIGHT].y) * step);
    if (fabs(turn) < IDLE)
        xr->turned = 0;
    if (fabs(turn) < PUSHED || xr->turned)
        return;
    xr->turned = 1;
    head_of(views, head);
    point_in_scene(place, head, there);
    turn_by(place, turn > 0 ? TURN : -TURN);
    hold(place, head, there);
}

static int read_hand(fxs_xr *xr, int hand, XrTime time, fxs_xr_hand *now, XrVector2f *stick, fxs_message *why)
{
    XrActionStateGetInfo info = {.type = XR_TYPE_ACTION_STATE_GET_INFO, .action = xr->grab,
                                 .subactionPath = xr->hands[hand]};
    XrActionStateBoolean grab = {.type = XR_TYPE_ACTION_STATE_BOOLEAN};
    XrActionStateVector2f walked = {.type = XR_TYPE_ACTION_STATE_VECTOR2F};
    XrPosef pose;
    int error = FXS_XR_TRY(GetActionStateBoolean, (xr->session, &info, &grab));
    info.action = xr->walk;
    error = error ? error : FXS_XR_TRY(GetActionStateVector2f, (xr->session, &info, &walked));
    *stick = error || !walked.isActive ? (XrVector2f){0, 0} : walked.currentState;
    now->grips = !error && grab.isActive && grab.currentState && find_pose(xr, now->space, time, &pose);
    if (now->grips) {
        now->at[0] = pose.position.x;
        now->at[1] = pose.position.y;
        now->at[2] = pose.position.z;
    }
    return error;
}

int fxs_xr_move(fxs_xr *xr, const XrView views[2], XrTime time, fxs_message *why)
{
    const XrActiveActionSet active = {.actionSet = xr->actions};
    const XrActionsSyncInfo info = {.type = XR_TYPE_ACTIONS_SYNC_INFO, .countActiveActionSets = 1,
                                    .activeActionSets = &active};
    fxs_xr_hand now[FXS_XR_HANDS] = {xr->hand[0], xr->hand[1]};
    XrVector2f sticks[FXS_XR_HANDS];
    const double seconds = xr->before ? fmin((double)(time - xr->before) / 1e9, 0.1) : 0;
    place_room(xr, views);
    xr->before = time;
    const XrResult synced = xr->call.SyncActions(xr->session, &info);
    int error = fxs_xr_check(xr, synced, "xrSyncActions", why);
    if (synced == XR_SESSION_NOT_FOCUSED)
        xr->hand[0].grips = xr->hand[1].grips = 0;
    if (error || synced == XR_SESSION_NOT_FOCUSED)
        return error;
    for (int i = 0; i < FXS_XR_HANDS && !error; i++)
        error = read_hand(xr, i, time, &now[i], &sticks[i], why);
    if (error)
        return error;
    walk(xr, views, sticks, seconds);
    pull(&xr->place, xr->hand, now);
    memcpy(xr->hand, now, sizeof now);
    return 0;
}

#endif
