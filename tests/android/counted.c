/* Counts the blocks of memory that the library holds. The linker's option --wrap sends its calls here; a library of the
 * system that frees or allocates for it has wrappers too. */
#include <stdlib.h>
#include <string.h>

#include <jni.h>

static long blocks;

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *block, size_t size);
char *__real_strdup(const char *text);
int __real_posix_memalign(void **block, size_t alignment, size_t size);
void __real_free(void *block);

static void *counted(void *block)
{
    __atomic_add_fetch(&blocks, block != NULL, __ATOMIC_SEQ_CST);
    return block;
}

void *__wrap_malloc(size_t size)
{
    return counted(__real_malloc(size));
}

void *__wrap_calloc(size_t count, size_t size)
{
    return counted(__real_calloc(count, size));
}

void *__wrap_realloc(void *block, size_t size)
{
    void *const made = __real_realloc(block, size);
    return block ? made : counted(made);
}

char *__wrap_strdup(const char *text)
{
    return counted(__real_strdup(text));
}

int __wrap_posix_memalign(void **block, size_t alignment, size_t size)
{
    const int error = __real_posix_memalign(block, alignment, size);
    counted(error ? NULL : *block);
    return error;
}

void __wrap_free(void *block)
{
    __atomic_sub_fetch(&blocks, block != NULL, __ATOMIC_SEQ_CST);
    __real_free(block);
}

JNIEXPORT jlong JNICALL Java_org_fixsplat_StandIn_blocks(JNIEnv *env, jclass class)
{
    (void)env, (void)class;
    return __atomic_load_n(&blocks, __ATOMIC_SEQ_CST);
}
