/* A qemu plugin (TCG plugin API, version 1) that counts the instructions executed in given functions. qemu-aarch64
   -plugin file=count_instructions.so,NAME=START-END,... prints "NAME COUNT" for each NAME. A NAME may have several
   address ranges. Addresses are hexadecimal. */
#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Declarations from qemu-plugin.h, which Debian does not package. */
typedef uint64_t qemu_plugin_id_t;
struct qemu_plugin_tb;
struct qemu_plugin_insn;
enum qemu_plugin_op { QEMU_PLUGIN_INLINE_ADD_U64 };
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *tb);
uint64_t qemu_plugin_tb_vaddr(const struct qemu_plugin_tb *tb);
void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t id,
                                           void (*translated)(qemu_plugin_id_t, struct qemu_plugin_tb *));
void qemu_plugin_register_vcpu_tb_exec_inline(struct qemu_plugin_tb *tb, enum qemu_plugin_op op, void *sum,
                                              uint64_t add);
void qemu_plugin_register_atexit_cb(qemu_plugin_id_t id, void (*ended)(qemu_plugin_id_t, void *), void *argument);
void qemu_plugin_outs(const char *text);

__attribute__((visibility("default"))) int qemu_plugin_version = 1;

enum { MOST = 256 };

static struct range {
    char name[32];
    uint64_t start, end, count;
} ranges[MOST];
static int range_count;

static void count_block(qemu_plugin_id_t id, struct qemu_plugin_tb *tb)
{
    const uint64_t at = qemu_plugin_tb_vaddr(tb);
    (void)id;
    for (struct range *r = ranges; r < ranges + range_count; r++)
        if (at >= r->start && at < r->end)
            qemu_plugin_register_vcpu_tb_exec_inline(tb, QEMU_PLUGIN_INLINE_ADD_U64, &r->count,
                                                     qemu_plugin_tb_n_insns(tb));
}

static void print(qemu_plugin_id_t id, void *argument)
{
    (void)id, (void)argument;
    for (int i = 0; i < range_count; i++) {
        char line[64];
        snprintf(line, sizeof line, "%s %" PRIu64 "\n", ranges[i].name, ranges[i].count);
        qemu_plugin_outs(line);
    }
}

__attribute__((visibility("default"))) int qemu_plugin_install(qemu_plugin_id_t id, const void *info, int argc,
                                                               char **argv)
{
    (void)info;
    for (int i = 0; i < argc; i++) {
        struct range *r = &ranges[range_count];
        if (range_count++ == MOST ||
            sscanf(argv[i], "%31[^=]=%" SCNx64 "-%" SCNx64, r->name, &r->start, &r->end) != 3)
            return 1;
    }
    qemu_plugin_register_vcpu_tb_trans_cb(id, count_block);
    qemu_plugin_register_atexit_cb(id, print, NULL);
    return 0;
}
