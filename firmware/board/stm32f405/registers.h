/* registers.h: the registers of the STM32F405 that are used here (names and bits as in RM0090). */
#ifndef REGISTERS_H
#define REGISTERS_H

#include <stdbool.h>
#include <stdint.h>

/* Tests put memory of their own in the place of the registers, and act as the hardware where it
 * is POLLED(). */
#ifndef REGISTERS_AT
#define REGISTERS_AT(type, address) ((type *)(address))
#define POLLED(address) ((void)0)
#define SLEEP() __asm volatile("dsb\n\twfi" ::: "memory")
#define INTERRUPTS_OFF() __asm volatile("cpsid i" ::: "memory")
#define INTERRUPTS_ON() __asm volatile("cpsie i\n\tisb" ::: "memory")
#define BARRIER() __asm volatile("dsb\n\tisb" ::: "memory")
#endif

typedef volatile uint32_t reg;

typedef struct rcc_registers {
    reg CR, PLLCFGR, CFGR, CIR, AHB1RSTR, AHB2RSTR, AHB3RSTR, reserved0, APB1RSTR, APB2RSTR, reserved1[2];
    reg AHB1ENR, AHB2ENR, AHB3ENR, reserved2, APB1ENR, APB2ENR, reserved3[10], BDCR, CSR;
} rcc_registers;

typedef struct flash_registers {
    reg ACR, KEYR, OPTKEYR, SR, CR, OPTCR;
} flash_registers;

typedef struct pwr_registers {
    reg CR, CSR;
} pwr_registers;

typedef struct exti_registers {
    reg IMR, EMR, RTSR, FTSR, SWIER, PR;
} exti_registers;

typedef struct mpu_registers {
    reg TYPE, CTRL, RNR, RBAR, RASR;
} mpu_registers;

typedef struct gpio_registers {
    reg MODER, OTYPER, OSPEEDR, PUPDR, IDR, ODR, BSRR, LCKR, AFR[2];
} gpio_registers;

typedef struct usart_registers {
    reg SR, DR, BRR, CR1, CR2, CR3;
} usart_registers;

typedef struct spi_registers {
    reg CR1, CR2, SR, DR;
} spi_registers;

typedef struct tim_registers {
    reg CR1, CR2, SMCR, DIER, SR, EGR, CCMR1, CCMR2, CCER, CNT, PSC, ARR, RCR, CCR[4], BDTR;
} tim_registers;

typedef struct adc_registers {
    reg SR, CR1, CR2, SMPR1, SMPR2, JOFR[4], HTR, LTR, SQR1, SQR2, SQR3, JSQR, JDR[4], DR;
} adc_registers;

typedef struct adc_common_registers {
    reg CSR, CCR;
} adc_common_registers;

typedef struct iwdg_registers {
    reg KR, PR, RLR, SR;
} iwdg_registers;

typedef struct systick_registers {
    reg CTRL, LOAD, VAL;
} systick_registers;

typedef struct nvic_registers {
    reg ISER[8], reserved0[24], ICER[8], reserved1[24], ISPR[8], reserved2[120], IPR[60];
} nvic_registers;

typedef struct scb_registers {
    reg CPUID, ICSR, VTOR, AIRCR, SCR, CCR, SHPR[3], SHCSR, reserved[24], CPACR;
} scb_registers;

typedef struct syscfg_registers {
    reg MEMRMP, PMC, EXTICR[4];
} syscfg_registers;

typedef struct dwt_registers {
    reg CTRL, CYCCNT;
} dwt_registers;

#define TIM2 REGISTERS_AT(tim_registers, 0x40000000u)
#define TIM3 REGISTERS_AT(tim_registers, 0x40000400u)
#define IWDG REGISTERS_AT(iwdg_registers, 0x40003000u)
#define PWR REGISTERS_AT(pwr_registers, 0x40007000u)
#define TIM1 REGISTERS_AT(tim_registers, 0x40010000u)
#define USART1 REGISTERS_AT(usart_registers, 0x40011000u)
#define ADC1 REGISTERS_AT(adc_registers, 0x40012000u)
#define ADC_COMMON REGISTERS_AT(adc_common_registers, 0x40012300u)
#define SPI1 REGISTERS_AT(spi_registers, 0x40013000u)
#define SYSCFG REGISTERS_AT(syscfg_registers, 0x40013800u)
#define EXTI REGISTERS_AT(exti_registers, 0x40013c00u)
#define GPIO(port) REGISTERS_AT(gpio_registers, 0x40020000u + 0x400u * (port)) /* 0 = A */
#define RCC REGISTERS_AT(rcc_registers, 0x40023800u)
#define FLASH REGISTERS_AT(flash_registers, 0x40023c00u)
#define UNIQUE_ID REGISTERS_AT(const reg, 0x1fff7a10u) /* three words */
#define DWT REGISTERS_AT(dwt_registers, 0xe0001000u)
#define SYSTICK REGISTERS_AT(systick_registers, 0xe000e010u)
#define NVIC REGISTERS_AT(nvic_registers, 0xe000e100u)
#define MPU REGISTERS_AT(mpu_registers, 0xe000ed90u)
#define SCB REGISTERS_AT(scb_registers, 0xe000ed00u)
#define DEMCR REGISTERS_AT(reg, 0xe000edfcu)
#define IDCODE REGISTERS_AT(const reg, 0xe0042000u) /* of the chip: revision in the upper half */

enum {
    RCC_CR_HSION = 1u << 0,
    RCC_CR_HSIRDY = 1u << 1,
    RCC_CR_HSEON = 1u << 16,
    RCC_CR_HSERDY = 1u << 17,
    RCC_CR_CSSON = 1u << 19,
    RCC_CR_PLLON = 1u << 24,
    RCC_CR_PLLRDY = 1u << 25,
    RCC_PLLCFGR_HSE = 1u << 22,
    RCC_CFGR_SW = 3u << 0,
    RCC_CFGR_SW_PLL = 2u << 0,
    RCC_CFGR_SWS = 3u << 2,
    RCC_CFGR_SWS_PLL = 2u << 2,
    RCC_CFGR_APB1_BY_4 = 5u << 10,
    RCC_CFGR_APB2_BY_2 = 4u << 13,
    RCC_CSR_RMVF = 1u << 24,
    RCC_CSR_BORRSTF = 1u << 25,
    RCC_CSR_PORRSTF = 1u << 27,
    RCC_CSR_IWDGRSTF = 1u << 29,
    RCC_AHB1ENR_GPIOABC = 7u << 0,
    RCC_APB1ENR_TIM2 = 1u << 0,
    RCC_APB1ENR_TIM3 = 1u << 1,
    RCC_APB1ENR_PWR = 1u << 28,
    RCC_APB2ENR_TIM1 = 1u << 0,
    RCC_APB2ENR_USART1 = 1u << 4,
    RCC_APB2ENR_ADC1 = 1u << 8,
    RCC_APB2ENR_SPI1 = 1u << 12,
    RCC_APB2ENR_SYSCFG = 1u << 14,
    FLASH_ACR_LATENCY = 7u << 0,
    FLASH_ACR_5_WAITS = 5u << 0,
    FLASH_ACR_PREFETCH = 1u << 8,
    FLASH_ACR_CACHES = 3u << 9, /* instructions, data */
    FLASH_ACR_DATA_CACHE = 1u << 10,
    FLASH_ACR_DATA_RESET = 1u << 12,
    FLASH_SR_ERRORS = 1u << 1 | 15u << 4,
    FLASH_SR_BSY = 1u << 16,
    FLASH_CR_PG = 1u << 0,
    FLASH_CR_SER = 1u << 1,
    FLASH_CR_WORDS = 2u << 8, /* 32 bits at a time: 2.7 V or more */
    FLASH_CR_STRT = 1u << 16,
    FLASH_OPTCR_OPTLOCK = 1u << 0,
    FLASH_OPTCR_OPTSTRT = 1u << 1,
    FLASH_OPTCR_BOR = 3u << 2, /* 0: 2.8 V; 3: off */
    IDCODE_REVISION_A = 0x1000,
    PWR_CR_PVDE = 1u << 4,
    PWR_CR_PLS_2V9 = 7u << 5,
    EXTI_PVD = 1u << 16,
    MPU_CTRL_ENABLE = 1u << 0,
    MPU_CTRL_PRIVDEFENA = 1u << 2,
    MPU_RASR_ENABLE = 1u << 0,
    MPU_RASR_XN = 1u << 28,
    USART_SR_ORE = 1u << 3,
    USART_SR_RXNE = 1u << 5,
    USART_SR_TXE = 1u << 7,
    USART_CR1_RE = 1u << 2,
    USART_CR1_TE = 1u << 3,
    USART_CR1_RXNEIE = 1u << 5,
    USART_CR1_TXEIE = 1u << 7,
    USART_CR1_UE = 1u << 13,
    SPI_CR1_CPHA = 1u << 0,
    SPI_CR1_CPOL = 1u << 1,
    SPI_CR1_MSTR = 1u << 2,
    SPI_CR1_BY_8 = 2u << 3,
    SPI_CR1_BY_16 = 3u << 3,
    SPI_CR1_SPE = 1u << 6,
    SPI_CR1_SSI = 1u << 8,
    SPI_CR1_SSM = 1u << 9,
    SPI_CR1_DFF = 1u << 11,
    SPI_SR_RXNE = 1u << 0,
    TIM_CR1_CEN = 1u << 0,
    TIM_CR1_OPM = 1u << 3, /* ends by itself */
    TIM_CR1_ARPE = 1u << 7,
    TIM_EGR_UG = 1u << 0,
    TIM_SMCR_ENCODER = 3u << 0,      /* counts on both edges of both inputs */
    TIM_CCMR1_INPUTS = 1u | 1u << 8, /* TI1 and TI2 */
    TIM_CCMR1_FILTERS = 3u << 4 | 3u << 12,
    TIM_CCMR1_PWM = 6u << 4 | 1u << 3,      /* mode 1, preloaded */
    TIM_CCMR1_PWM_LATE = 7u << 4 | 1u << 3, /* mode 2: high at the end of each period; preloaded */
    TIM_SR_BIF = 1u << 7,
    TIM_CCER_CC1E = 1u << 0,
    TIM_BDTR_OSSI = 1u << 10,
    TIM_BDTR_BKE = 1u << 12,
    TIM_BDTR_MOE = 1u << 15,
    ADC_SR_EOC = 1u << 1,
    ADC_CR2_ADON = 1u << 0,
    ADC_CR2_SWSTART = 1u << 30,
    ADC_CCR_BY_4 = 1u << 16,
    SYSTICK_CTRL_ON = 7u << 0, /* processor clock, interrupt, enable */
    SCB_CPACR_FPU = 15u << 20,
    SCB_SHCSR_FAULTS = 7u << 16,
    SCB_AIRCR_RESET = 0x05fa0004u,
    DEMCR_TRCENA = 1u << 24,
    DWT_CTRL_CYCCNTENA = 1u << 0,
    PVD_IRQ = 1,
    USART1_IRQ = 37
};

#define FLASH_CR_LOCK (1u << 31)
#define FLASH_KEY_1 0x45670123u
#define FLASH_KEY_2 0xcdef89abu

/* Polls a register until the bits of mask are as in value; false if they are not after so many polls. */
static inline bool wait_for(const reg *address, uint32_t mask, uint32_t value, uint32_t polls) {
    for (; polls > 0; polls--) {
        POLLED(address);
        if ((*address & mask) == value)
            return true;
    }
    return false;
}

#endif
